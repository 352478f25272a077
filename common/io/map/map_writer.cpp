// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/map/map_writer.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <fcntl.h>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "common/io/map/map_yaml.hpp"

namespace clearway::io {
namespace {

using core::GridGeometry;
using core::OccupancyGrid;

[[noreturn]] void Fail(const std::filesystem::path& path, const std::string& what) {
  const int reason = errno;
  throw std::runtime_error(path.string() + ": " + what + ": " +
                           std::generic_category().message(reason));
}

// A file that is written beside the one that it becomes; gone unless it became it.
class NewFile {
 public:
  explicit NewFile(std::filesystem::path target) : target_(std::move(target)) {
    const std::string stem = target_.string() + ".new." + std::to_string(getpid()) + ".";
    constexpr int kAttempts = 1000;
    for (int i = 0; i < kAttempts && descriptor_ < 0; ++i) {
      temporary_ = stem + std::to_string(i);
      descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ < 0 && errno != EEXIST) break;
    }
    if (descriptor_ < 0) Fail(target_, "cannot be written");
  }
  ~NewFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!temporary_.empty()) unlink(temporary_.c_str());
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void Write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) Fail(target_, "cannot be written");
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void Publish() {
    if (fsync(descriptor_) != 0) Fail(target_, "cannot be brought to the disk");
    const int descriptor = descriptor_;
    descriptor_ = -1;
    if (close(descriptor) != 0) Fail(target_, "cannot be written");
    if (rename(temporary_.c_str(), target_.c_str()) != 0) Fail(target_, "cannot be put in place");
    temporary_.clear();
  }

 private:
  std::filesystem::path target_;
  std::string temporary_;
  int descriptor_ = -1;
};

void WriteWhole(const std::filesystem::path& path, std::string_view bytes) {
  NewFile file(path);
  file.Write(bytes);
  file.Publish();
}

// Without it a renamed file may be gone after a power cut.
void SyncFolder(const std::filesystem::path& folder) {
  const std::string name = folder.empty() ? "." : folder.string();
  const int descriptor = open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) Fail(folder, "cannot be brought to the disk");
  const int result = fsync(descriptor);
  // Some file systems have no such thing for folders and say so.
  const bool failed = result != 0 && errno != EINVAL;
  const int reason = errno;
  close(descriptor);
  errno = reason;
  if (failed) Fail(folder, "cannot be brought to the disk");
}

std::uint8_t ShadeOf(std::uint8_t cell) {
  constexpr std::uint8_t kBlack = 0;
  constexpr std::uint8_t kWhite = 254;
  constexpr std::uint8_t kGrey = 205;
  if (cell > OccupancyGrid::kOccupied) return kGrey;
  if (cell >= kLeastOccupied) return kBlack;
  return cell <= kMostFree ? kWhite : kGrey;
}

std::string FormatPgm(const OccupancyGrid& grid) {
  const GridGeometry& geometry = grid.geometry;
  std::string bytes =
      "P5\n" + std::to_string(geometry.width) + " " + std::to_string(geometry.height) + "\n255\n";
  bytes.reserve(bytes.size() + grid.cells.size());
  for (int row = geometry.height - 1; row >= 0; --row) {
    const std::size_t first = geometry.IndexOf({0, row});
    for (std::size_t i = first; i < first + static_cast<std::size_t>(geometry.width); ++i) {
      bytes += static_cast<char>(ShadeOf(grid.cells[i]));
    }
  }
  return bytes;
}

// The shortest decimal that gives the same number back.
std::string Shortest(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string FormatYaml(const GridGeometry& geometry, const std::string& image) {
  YAML::Emitter name;
  name << image;
  return std::string("image: ") + name.c_str() +
         "\n"
         "mode: trinary\n"
         "resolution: " +
         Shortest(geometry.resolution_m) +
         "\n"
         "origin: [" +
         Shortest(geometry.origin_x_m) + ", " + Shortest(geometry.origin_y_m) + ", " +
         Shortest(geometry.origin_yaw_rad) +
         "]\n"
         "negate: 0\n"
         "occupied_thresh: 0.65\n"
         "free_thresh: 0.196\n";
}

// Whether a reader finds the image: a file's name need not be text.
bool NamesImage(const std::string& text, const std::string& yaml, const std::string& image) {
  try {
    return ParseMapYaml(text, yaml).image == image;
  } catch (const ReadError&) {
    return false;
  }
}

}  // namespace

void SaveMap(const OccupancyGrid& grid, const std::filesystem::path& yaml) {
  if (!grid.geometry.IsValid() || grid.cells.size() != grid.geometry.num_cells()) {
    throw std::invalid_argument("SaveMap: the grid's geometry or number of cells is not valid");
  }
  std::filesystem::path image = yaml;
  image.replace_extension(".pgm");
  if (image == yaml || !yaml.has_filename()) {
    throw std::invalid_argument(yaml.string() + ": expected the name of a YAML file");
  }
  const std::string text = FormatYaml(grid.geometry, image.filename().string());
  if (!NamesImage(text, yaml.string(), image.filename().string())) {
    throw std::runtime_error(yaml.string() + ": expected a name that can be written in YAML");
  }
  WriteWhole(image, FormatPgm(grid));
  WriteWhole(yaml, text);
  SyncFolder(yaml.parent_path());
}

}  // namespace clearway::io

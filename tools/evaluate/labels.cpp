// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/labels.hpp"

#include <algorithm>
#include <numbers>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "common/core/geometry/pose.hpp"
#include "common/io/file_bytes.hpp"
#include "common/io/read_error.hpp"

namespace clearway::evaluate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kMaxCoordinate_m = 10000.0;
constexpr double kMinSize_m = 0.001;
constexpr double kMaxSize_m = 1000.0;
constexpr double kMaxYaw_rad = 2.0 * std::numbers::pi;  // Above it, degrees were written.

// What stands there, cut to fit a message; bytes that are no text are replaced.
std::string Shown(const Json& value) {
  return io::Quoted(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string ShownNumber(double value) {
  return Json(value).dump();
}

// Where in a file of labels something stands.
struct Place {
  const std::string& file;
  std::string key;

  [[nodiscard]] io::ReadError Error(const std::string& text) const {
    return io::ErrorInFile(file, "key " + io::Quoted(key) + ": " + text);
  }
};

// One box of a list; its fields by name.
class BoxReader {
 public:
  BoxReader(const Place& place, std::size_t index, const Json& box)
      : place_(place), index_(index), box_(box) {
    if (!box.is_object()) {
      throw Error("expected an object with x, y, z, l, w, h, yaw, cls and n, not " + Shown(box));
    }
  }

  [[nodiscard]] Box Read() const {
    Box box;
    const Eigen::Vector3d centre(Coordinate("x"), Coordinate("y"), Coordinate("z"));
    box.size_m = {Size("l"), Size("w"), Size("h")};
    box.T_F_box = core::FromRpy(centre, {0.0, 0.0, Number("yaw", -kMaxYaw_rad, kMaxYaw_rad)});
    box.kind = Kind();
    box.points = Points();
    return box;
  }

 private:
  [[nodiscard]] double Coordinate(const char* name) const {
    return Number(name, -kMaxCoordinate_m, kMaxCoordinate_m);
  }

  [[nodiscard]] double Size(const char* name) const { return Number(name, kMinSize_m, kMaxSize_m); }

  [[nodiscard]] double Number(const char* name, double lowest, double highest) const {
    const std::string allowed =
        "a number in [" + ShownNumber(lowest) + ", " + ShownNumber(highest) + "]";
    const Json& value = Field(name, allowed);
    if (!value.is_number()) throw Refusal(name, value, allowed);
    const auto number = value.get<double>();
    if (!(number >= lowest && number <= highest)) throw Refusal(name, value, allowed);
    return number;
  }

  [[nodiscard]] std::int64_t Points() const {
    constexpr std::uint64_t kMaxPoints = 1'000'000'000;
    const std::string allowed = "a whole number in [0, " + std::to_string(kMaxPoints) + "]";
    const Json& value = Field("n", allowed);
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() > kMaxPoints) {
      throw Refusal("n", value, allowed);
    }
    return value.get<std::int64_t>();
  }

  [[nodiscard]] std::string Kind() const {
    const Json& value = Field("cls", "a text");
    if (!value.is_string()) throw Refusal("cls", value, "a text");
    return value.get<std::string>();
  }

  [[nodiscard]] const Json& Field(const char* name, const std::string& allowed) const {
    const auto field = box_.find(name);
    if (field == box_.end()) {
      throw Error("field \"" + std::string(name) + "\" is missing; expected " + allowed);
    }
    return *field;
  }

  [[nodiscard]] io::ReadError Refusal(const char* name,
                                      const Json& value,
                                      const std::string& allowed) const {
    return Error("field \"" + std::string(name) + "\" is " + Shown(value) + "; expected " +
                 allowed);
  }

  [[nodiscard]] io::ReadError Error(const std::string& text) const {
    return place_.Error("box " + std::to_string(index_) + ": " + text);
  }

  const Place& place_;
  std::size_t index_;
  const Json& box_;
};

std::vector<Box> ReadBoxes(const Place& place, const Json& list) {
  if (!list.is_array()) throw place.Error("expected a list of boxes, not " + Shown(list));
  std::vector<Box> boxes;
  for (const Json& box : list) boxes.push_back(BoxReader(place, boxes.size(), box).Read());
  return boxes;
}

// The file as JSON. The library keeps the last of two members with one name: refused for the keys
// of the scans, where it would lose labels.
Json Parse(const fs::path& file) {
  std::set<std::string> keys;
  const auto refuse_twice = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth == 1 && event == Json::parse_event_t::key &&
        !keys.insert(parsed.get<std::string>()).second) {
      throw Place{file.native(), parsed.get<std::string>()}.Error("stands twice; expected once");
    }
    return true;
  };
  try {
    return Json::parse(io::ReadFileBytes(file), refuse_twice);
  } catch (const Json::exception& error) {
    throw io::ErrorInFile(file.string(), "is not JSON: " + std::string(error.what()));
  }
}

Labels ReadObject(const fs::path& file) {
  const Json json = Parse(file);
  if (!json.is_object()) {
    throw io::ErrorInFile(file.string(),
                          "expected one object {\"stem\": [boxes], ...}, not " + Shown(json) +
                              "; lists of boxes, one file a scan, are given as their folder");
  }
  Labels labels;
  for (const auto& [key, list] : json.items()) {
    labels.emplace(key, ReadBoxes({file.native(), key}, list));
  }
  return labels;
}

Labels ReadFolder(const fs::path& folder) {
  std::set<fs::path> files;  // In order, so that of several problems always the same is told.
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") files.insert(entry.path());
  }
  Labels labels;
  for (const fs::path& file : files) {
    const std::string stem = file.stem().string();
    labels.emplace(stem, ReadBoxes({file.native(), stem}, Parse(file)));
  }
  return labels;
}

}  // namespace

Labels ReadLabels(const fs::path& path) {
  Labels labels = fs::is_directory(path) ? ReadFolder(path) : ReadObject(path);
  if (labels.empty()) {
    throw io::ErrorInFile(path.string(),
                          "holds no labels; expected an object {\"stem\": [boxes], ...} in a file, "
                          "or a folder with <stem>.json");
  }
  return labels;
}

}  // namespace clearway::evaluate

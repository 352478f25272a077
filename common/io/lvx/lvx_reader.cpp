// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lvx/lvx_reader.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include "common/io/lvx/lvx_float_package.hpp"
#include "common/io/lvx/lvx_source.hpp"

namespace clearway::io {
namespace {

using core::livox::ByteView;
using core::livox::Load;

constexpr std::size_t kMaxFrameHeaderBytes = 32;
constexpr std::uint8_t kPacketVersion = 5;

std::string Text(std::uint64_t number) {
  return std::to_string(number);
}

}  // namespace

struct LvxReader::Impl {
  lvx::Source source;
  std::string file;
  std::uint64_t size = 0;
  std::uint64_t position = 0;  // Of what is read next.
  LvxHeader header;
  lvx::Sizes sizes;
  LvxReport report;

  // The frame that is being read; what follows its end is the next one.
  bool in_frame = false;
  std::uint64_t frame_end = 0;        // Never beyond the file.
  std::uint64_t stated_end = 0;       // As the file says; 0: it was never finished.
  std::uint64_t stated_packages = 0;  // Version 1.0.
  std::uint64_t packages_met = 0;     // Of this frame, of any kind.

  std::array<std::byte, lvx::kMaxPackageBytes> package{};
  lvx::FloatPackage float_package;

  Impl(std::unique_ptr<std::istream> stream, std::string name)
      : source(std::move(stream)), file(std::move(name)), size(source.size()) {
    core::livox::Bytes start(
        static_cast<std::size_t>(std::min<std::uint64_t>(size, lvx::kMaxHeaderBytes)));
    if (!source.ReadAt(0, start)) throw ErrorInFile(file, "cannot be read");
    const lvx::ParsedHeader parsed = lvx::ParseHeader(start, file);
    header = parsed.header;
    sizes = lvx::SizesOf(header.version);
    position = parsed.bytes;
  }

  void Note(std::uint64_t byte, const std::string& text) {
    if (report.first_problem.empty()) report.first_problem = ErrorAtByte(file, byte, text).what();
  }

  void NoteCut(std::uint64_t byte, const std::string& text) {
    if (report.cut_at) return;
    report.cut_at = byte;
    report.cut = ErrorAtByte(file, byte, text).what();
  }

  void LoseWay(std::uint64_t byte, const std::string& text) {
    Note(byte, text);
    ++report.damages;
    in_frame = false;
    position = source.FindFrame(byte, sizes.frame_header);
    report.lost_bytes += position - byte;
  }

  void Cut(std::uint64_t byte) {
    NoteCut(byte,
            "the file is cut short: it ends at byte " + Text(size) + " inside a frame that " +
                (stated_end == 0 ? "was never finished" : "ends at byte " + Text(stated_end)));
    in_frame = false;
    position = size;
  }

  // The file became shorter, or the disk gave up, while it was read.
  std::nullopt_t Unreadable() {
    NoteCut(position, "the file cannot be read on from here");
    in_frame = false;
    position = size;
    return std::nullopt;
  }

  [[nodiscard]] bool EndsInFile() const { return stated_end != 0 && stated_end <= size; }

  // False at the end of the file.
  bool BeginFrame() {
    if (position == size) return false;
    if (size - position < sizes.frame_header) {
      NoteCut(position, "the file is cut short: it ends inside a frame's header");
      position = size;
      return false;
    }
    std::array<std::byte, kMaxFrameHeaderBytes> bytes{};
    if (!source.ReadAt(position, std::span(bytes).first(sizes.frame_header))) {
      Unreadable();
      return false;
    }
    const auto own = Load<std::uint64_t>(bytes, 0);
    stated_end = Load<std::uint64_t>(bytes, 8);
    if (own != position) {
      LoseWay(position, "no frame: a frame's header begins with its own place, here " + Text(own));
      return true;
    }
    const std::uint64_t begin = position + sizes.frame_header;
    if (stated_end != 0 && stated_end < begin) {
      LoseWay(position, "a frame that ends before it begins, at byte " + Text(stated_end));
      return true;
    }
    if (header.version == LvxVersion::k1_0) stated_packages = Load<std::uint64_t>(bytes, 24);
    frame_end = EndsInFile() ? stated_end : size;
    packages_met = 0;
    in_frame = true;
    position = begin;
    ++report.frames;
    return true;
  }

  void EndFrame() {
    if (!EndsInFile()) {
      Cut(position);
      return;
    }
    if (header.version == LvxVersion::k1_0 && packages_met != stated_packages) {
      Note(position,
           "a frame ends that holds " + Text(packages_met) + " packages and states " +
               Text(stated_packages));
      ++report.damages;
    }
    in_frame = false;
  }

  // The next package of the frame; nothing where there is none to give.
  std::optional<LvxPackage> NextInFrame() {
    const std::uint64_t left = frame_end - position;
    if (left == 0) {
      EndFrame();
      return std::nullopt;
    }
    if (!EndsInFile() && source.IsFrame(position, sizes.frame_header)) {
      LoseWay(position,
              "a frame begins inside another one, which ends at byte " + Text(stated_end));
      return std::nullopt;
    }
    if (left < lvx::kPackageHeadBytes) return Incomplete(left);
    const std::span<std::byte> head = std::span(package).first(lvx::kPackageHeadBytes);
    if (!source.ReadAt(position, head)) return Unreadable();
    const std::optional<std::size_t> bytes = BytesOf(head);
    if (!bytes) return std::nullopt;
    if (*bytes > left) return Incomplete(left);
    return Take(*bytes);
  }

  std::optional<LvxPackage> Incomplete(std::uint64_t left) {
    if (!EndsInFile()) {
      Cut(position);
    } else {
      LoseWay(position, "the last " + Text(left) + " bytes of a frame are no whole package");
    }
    return std::nullopt;
  }

  // Of the package with this head; nothing, and the way is lost, where it is none.
  std::optional<std::size_t> BytesOf(ByteView head) {
    const auto version = Load<std::uint8_t>(head, 1);
    const auto timestamp_type = Load<std::uint8_t>(head, 9);
    const auto data_type = Load<std::uint8_t>(head, 10);
    const auto bytes = lvx::PackageBytes(header.version, data_type);
    const auto refuse = [&](const std::string& what, unsigned value) {
      LoseWay(position, "no package: " + what + " " + std::to_string(value));
      return std::nullopt;
    };
    if (version != kPacketVersion) return refuse("its version must be 5 and is", version);
    if (!bytes) return refuse("there is no data type", data_type);
    if (timestamp_type > static_cast<std::uint8_t>(core::livox::TimestampType::kUnknown)) {
      return refuse("there is no type of time stamp", timestamp_type);
    }
    return bytes;
  }

  std::optional<LvxPackage> Take(std::size_t bytes) {
    const std::uint64_t byte = position;
    const auto data_type = Load<std::uint8_t>(package, 10);
    const auto index = Load<std::uint8_t>(package, 0);
    position += bytes;
    ++packages_met;
    const bool is_float = header.version == LvxVersion::k1_0;
    if (!core::livox::LayoutOf(data_type) || (is_float && data_type != 0)) {
      Note(byte, "a package of data type " + Text(data_type) + ", which no MID-70 sends");
      ++report.foreign_types;
      return std::nullopt;
    }
    if (Find(index) == nullptr) {
      Note(byte, "a package of device " + Text(index) + ", which the header does not list");
      ++report.unknown_devices;
      return std::nullopt;
    }
    const std::size_t body = bytes - lvx::kPackageHeadBytes;
    if (!source.ReadAt(byte + lvx::kPackageHeadBytes,
                       std::span(package).subspan(lvx::kPackageHeadBytes, body))) {
      return Unreadable();
    }
    LvxPackage given{.device_index = index,
                     .number = report.packages++,
                     .frame = report.frames - 1,
                     .byte = byte,
                     .packet = ByteView(package).subspan(1, bytes - 1),
                     .float_points = {}};
    if (is_float) {
      float_package = lvx::ConvertFloatPackage(package);
      given.packet = float_package.packet;
      given.float_points = float_package.points;
    }
    return given;
  }

  [[nodiscard]] const LvxDevice* Find(std::uint8_t index) const {
    const auto found = std::find_if(header.devices.begin(),
                                    header.devices.end(),
                                    [&](const LvxDevice& device) { return device.index == index; });
    return found != header.devices.end() ? &*found : nullptr;
  }
};

LvxReader::LvxReader(const std::filesystem::path& path)
    : impl_(std::make_unique<Impl>(lvx::OpenFile(path), path.string())) {}

LvxReader::LvxReader(std::string bytes, const std::string& file)
    : impl_(std::make_unique<Impl>(std::make_unique<std::istringstream>(std::move(bytes)), file)) {}

LvxReader::~LvxReader() = default;

const LvxHeader& LvxReader::header() const {
  return impl_->header;
}

const LvxDevice* LvxReader::DeviceWithIndex(std::uint8_t index) const {
  return impl_->Find(index);
}

std::optional<LvxPackage> LvxReader::Next() {
  while (impl_->in_frame || impl_->BeginFrame()) {
    if (!impl_->in_frame) continue;
    if (auto package = impl_->NextInFrame()) return package;
  }
  return std::nullopt;
}

const LvxReport& LvxReader::report() const {
  return impl_->report;
}

std::uint64_t LvxReader::position() const {
  return impl_->position;
}

std::uint64_t LvxReader::size() const {
  return impl_->size;
}

}  // namespace clearway::io

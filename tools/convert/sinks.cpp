// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/sinks.hpp"

#include <array>
#include <cstdio>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/io/lcm_log.hpp"
#include "common/io/lvx/lvx_writer.hpp"
#include "common/io/pcd_writer.hpp"
#include "common/io/scan_listing.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/lidar_points.hpp"

namespace clearway::convert {
namespace {

std::size_t IndexOf(int sensor) {
  return static_cast<std::size_t>(sensor);
}

class LogSink final : public SliceSink {
 public:
  LogSink(const std::filesystem::path& path,
          const std::vector<std::string>& sensors,
          const std::string& channel_prefix)
      : sensors_(sensors),
        channel_(channel_prefix + messages::channels::kLidarPoints.name),
        log_(path) {}

  void Take(const TimedSlice& slice) override {
    lidar_points_t message = messages::ToLcm(slice.slice, sensors_[IndexOf(slice.slice.sensor)]);
    message.session = slice.slice.session;
    message.sequence = slice.slice.sequence;
    message.lost_packets = static_cast<std::int32_t>(slice.lost_packets);
    message.time_source = slice.time_source;
    message.return_mode = slice.return_mode;
    log_.Write(slice.utime, channel_, messages::Encode(message));
    scans_.insert({slice.slice.sensor, slice.slice.scan_id});
    counts_.points += message.n;
    ++counts_.packets;
  }

  SinkCounts Finish() override {
    counts_.scans = static_cast<std::int64_t>(scans_.size());
    return counts_;
  }

 private:
  std::vector<std::string> sensors_;
  std::string channel_;
  io::LcmLogWriter log_;
  std::set<std::pair<int, std::int64_t>> scans_;
  SinkCounts counts_;
};

// What takes scans, not slices.
class ScanSink : public SliceSink {
 public:
  explicit ScanSink(std::size_t num_sensors) : collector_(num_sensors) {}

  void Take(const TimedSlice& slice) final {
    for (const CollectedScan& scan : collector_.Add(slice)) TakeAndCount(scan);
  }

  SinkCounts Finish() final {
    for (const CollectedScan& scan : collector_.Finish()) TakeAndCount(scan);
    counts_.unused = collector_.num_unused();
    Close(counts_);
    return counts_;
  }

 protected:
  virtual void TakeScan(const CollectedScan& scan) = 0;
  virtual void Close(SinkCounts& counts) = 0;

 private:
  void TakeAndCount(const CollectedScan& scan) {
    TakeScan(scan);
    ++counts_.scans;
    counts_.points += static_cast<std::int64_t>(scan.cloud_sensor.size());
  }

  ScanCollector collector_;
  SinkCounts counts_;
};

std::string StampName(std::int64_t utime) {
  std::array<char, 48> text{};
  std::snprintf(text.data(),
                text.size(),
                "%lld.%06lld.pcd",
                static_cast<long long>(utime / 1'000'000),
                static_cast<long long>(utime % 1'000'000));
  return text.data();
}

class FolderSink final : public ScanSink {
 public:
  FolderSink(const std::filesystem::path& folder, const std::vector<std::string>& sensors)
      : ScanSink(sensors.size()) {
    for (const std::string& sensor : sensors) {
      if (sensors.size() > 1 &&
          (sensor.empty() || sensor.find('/') != std::string::npos || sensor.front() == '.')) {
        throw std::runtime_error("sensor \"" + sensor + "\" is no name for a folder");
      }
      folders_.push_back(sensors.size() > 1 ? folder / sensor : folder);
      std::filesystem::create_directories(folders_.back());
      for (const auto& entry : std::filesystem::directory_iterator(folders_.back())) {
        if (!io::IsScanFile(entry.path())) continue;
        throw std::runtime_error(folders_.back().string() + ": holds scans already, " +
                                 entry.path().filename().string() +
                                 " among them; name a new folder");
      }
    }
  }

 private:
  void TakeScan(const CollectedScan& scan) override {
    if (scan.utime_start < 0) {
      throw std::runtime_error("a scan starts before 1970; its file cannot be named after it");
    }
    io::WritePcdBinary(folders_[IndexOf(scan.sensor)] / StampName(scan.utime_start),
                       scan.cloud_sensor);
  }
  void Close(SinkCounts& /*counts*/) override {}

  std::vector<std::filesystem::path> folders_;  // By sensor.
};

io::LvxHeader HeaderFor(const std::vector<std::string>& sensors) {
  io::LvxHeader header;
  std::set<std::string> codes;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    std::string code = sensors[i].substr(0, core::livox::Broadcast::kMaxCodeLength);
    if (!codes.insert(code).second) {
      throw std::runtime_error("two sensors begin with \"" + code +
                               "\"; devices of an LVX file are known by 15 characters");
    }
    header.devices.push_back({.lidar_code = code, .index = static_cast<std::uint8_t>(i)});
  }
  return header;
}

class LvxSink final : public ScanSink {
 public:
  LvxSink(const std::filesystem::path& path,
          const std::vector<std::string>& sensors,
          const std::vector<Packing>& packings)
      : ScanSink(sensors.size()), writer_(path, HeaderFor(sensors)) {
    for (const Packing packing : packings) packers_.emplace_back(packing);
  }

 private:
  void TakeScan(const CollectedScan& scan) override {
    newest_utime_ = scan.utime_end;
    Write(scan.sensor, packers_[IndexOf(scan.sensor)].Add(scan));
  }

  void Close(SinkCounts& counts) override {
    counts.points = 0;
    for (std::size_t i = 0; i < packers_.size(); ++i) {
      Write(static_cast<int>(i), packers_[i].Finish());
      counts.unwritable += packers_[i].num_unwritable();
      counts.points += packers_[i].num_points();
    }
    writer_.Close();
    counts.packets = writer_.packages();
  }

  void Write(int sensor, const std::vector<core::livox::Bytes>& packets) {
    for (const core::livox::Bytes& packet : packets) {
      const auto parsed = core::livox::ParsePacket(packet).packet;
      const auto utime =
          parsed ? static_cast<std::int64_t>(parsed->header.timestamp / 1000U) : newest_utime_;
      if (!writer_.Add(static_cast<std::uint8_t>(sensor), packet, utime)) {
        throw std::logic_error("a packet was made that is none");
      }
    }
  }

  io::LvxWriter writer_;
  std::vector<PacketPacker> packers_;  // By sensor.
  std::int64_t newest_utime_ = 0;
};

}  // namespace

std::unique_ptr<SliceSink> MakeLogSink(const std::filesystem::path& path,
                                       const std::vector<std::string>& sensors,
                                       const std::string& channel_prefix) {
  return std::make_unique<LogSink>(path, sensors, channel_prefix);
}

std::unique_ptr<SliceSink> MakeFolderSink(const std::filesystem::path& folder,
                                          const std::vector<std::string>& sensors) {
  return std::make_unique<FolderSink>(folder, sensors);
}

std::unique_ptr<SliceSink> MakeLvxSink(const std::filesystem::path& path,
                                       const std::vector<std::string>& sensors,
                                       const std::vector<Packing>& packings) {
  return std::make_unique<LvxSink>(path, sensors, packings);
}

}  // namespace clearway::convert

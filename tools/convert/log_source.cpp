// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "common/io/lcm_log.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/lidar_points.hpp"
#include "tools/convert/sources.hpp"

namespace clearway::convert {
namespace {

class LogSlices final : public SliceSource {
 public:
  explicit LogSlices(const SourceSettings& settings)
      : file_(settings.input),
        channel_(settings.channel_prefix + messages::channels::kLidarPoints.name) {
    io::LcmLogReader reader(file_);
    while (const auto event = reader.Next()) {
      if (event->channel != channel_) continue;
      const auto message = messages::Decode<lidar_points_t>(event->bytes);
      if (!message) continue;
      ++num_messages_;
      if (IndexOf(message->sensor) < 0) sensors_.push_back(message->sensor);
    }
    if (sensors_.empty()) {
      throw io::ErrorInFile(file_.string(), "holds no usable " + channel_ + " of an LCM log");
    }
    reader_ = std::make_unique<io::LcmLogReader>(file_);
  }

  [[nodiscard]] const std::vector<std::string>& sensors() const override { return sensors_; }

  [[nodiscard]] std::optional<TimedSlice> Next() override {
    while (const auto event = reader_->Next()) {
      if (event->channel != channel_) continue;
      const auto message = messages::Decode<lidar_points_t>(event->bytes);
      if (!message) {
        ++counts_.left_out;
        continue;
      }
      ++num_read_;
      TimedSlice next{.slice = messages::FromLcm(*message, IndexOf(message->sensor)),
                      .lost_packets = message->lost_packets,
                      .time_source = message->time_source,
                      .return_mode = message->return_mode,
                      .utime = event->utime};
      if (!core::IsValid(next.slice)) {
        ++counts_.left_out;
        continue;
      }
      ++counts_.packets;
      counts_.lost_packets += next.lost_packets;
      counts_.zero_returns += next.slice.zero_returns;
      return next;
    }
    return std::nullopt;
  }

  [[nodiscard]] double progress() const override {
    return static_cast<double>(num_read_) / static_cast<double>(num_messages_);
  }

  [[nodiscard]] SourceCounts counts() const override {
    SourceCounts counts = counts_;
    if (counts.left_out > 0) {
      counts.problems.push_back(file_.string() + ": " + std::to_string(counts.left_out) +
                                " messages on " + channel_ + " are no valid slices");
    }
    return counts;
  }

 private:
  [[nodiscard]] int IndexOf(const std::string& sensor) const {
    const auto found = std::find(sensors_.begin(), sensors_.end(), sensor);
    return found == sensors_.end() ? -1 : static_cast<int>(found - sensors_.begin());
  }

  std::filesystem::path file_;
  std::string channel_;
  std::vector<std::string> sensors_;
  std::int64_t num_messages_ = 0;
  std::int64_t num_read_ = 0;
  std::unique_ptr<io::LcmLogReader> reader_;
  SourceCounts counts_;
};

}  // namespace

std::unique_ptr<SliceSource> OpenLog(const SourceSettings& settings) {
  return std::make_unique<LogSlices>(settings);
}

}  // namespace clearway::convert

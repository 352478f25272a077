// SPDX-License-Identifier: BSD-3-Clause
#include "tools/replay/log_inputs.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "common/io/read_error.hpp"

namespace clearway::replay {
namespace {

namespace channels = messages::channels;

constexpr std::int64_t kEarliestUtime = 3'600'000'000;
constexpr std::int64_t kLatestUtime = 10'000'000'000'000'000;
constexpr std::size_t kMaxChannelsNamed = 20;
// Of an event in a log, beside its channel and its bytes.
constexpr std::size_t kEventHeadBytes = 28;

struct InputChannel {
  const char* name;
  messages::BusId bus;
  bool is_pose;
};
constexpr std::array kInputs{
    InputChannel{channels::kLidarPoints.name, channels::kLidarPoints.bus, false},
    InputChannel{channels::kOdometry.name, channels::kOdometry.bus, false},
    InputChannel{channels::kPose.name, channels::kPose.bus, true},
    InputChannel{channels::kPoseStatus.name, channels::kPoseStatus.bus, true},
};

const InputChannel* FindInput(const std::string& channel, const std::string& prefix) {
  if (!channel.starts_with(prefix)) return nullptr;
  const std::string_view name = std::string_view(channel).substr(prefix.size());
  const auto* const found = std::find_if(
      kInputs.begin(), kInputs.end(), [name](const auto& input) { return name == input.name; });
  return found == kInputs.end() ? nullptr : found;
}

}  // namespace

LogInputs::LogInputs(const Settings& settings)
    : settings_(settings),
      reader_(settings.log),
      log_bytes_(std::filesystem::file_size(settings.log)) {}

std::optional<Input> LogInputs::Next() {
  while (std::optional<io::LogEvent> event = reader_.Next()) {
    bytes_read_ += kEventHeadBytes + event->channel.size() + event->bytes.size();
    if (std::optional<Input> input = Accept(*std::move(event))) return input;
  }
  bytes_read_ = log_bytes_;
  return std::nullopt;
}

std::optional<Input> LogInputs::Accept(io::LogEvent event) {
  NoteChannel(event.channel);
  const InputChannel* const channel = FindInput(event.channel, settings_.channel_prefix);
  if (channel == nullptr) {
    ++counts_.not_inputs;
    return std::nullopt;
  }
  if (channel->is_pose && !settings_.with_pose) {
    ++counts_.left_out;
    return std::nullopt;
  }
  const std::optional<std::int64_t> utime = TimeOf(event);
  if (!utime) return std::nullopt;
  last_utime_ = utime;
  ++counts_.fed[channel->name];
  return Input{*utime, channel->bus, channel->name, std::move(event.bytes)};
}

std::optional<std::int64_t> LogInputs::TimeOf(const io::LogEvent& event) {
  const bool is_time = event.utime >= kEarliestUtime && event.utime <= kLatestUtime;
  if (!is_time || (last_utime_ && std::abs(event.utime - *last_utime_) > kLargestGapUs)) {
    if (counts_.refused++ == 0) {
      counts_.first_refused = event.channel + " at " + std::to_string(event.utime) + " us";
      if (is_time) {
        counts_.first_refused += ", " + std::to_string((event.utime - *last_utime_) / 1'000'000) +
                                 " s after the input before";
      }
    }
    return std::nullopt;
  }
  const std::int64_t step_back_us = last_utime_ ? *last_utime_ - event.utime : 0;
  if (step_back_us <= 0) return event.utime;
  ++counts_.stepped_back;
  counts_.largest_step_back_us = std::max(counts_.largest_step_back_us, step_back_us);
  return last_utime_;
}

double LogInputs::ShareRead() const {
  if (log_bytes_ == 0) return 1.0;
  return std::min(1.0, static_cast<double>(bytes_read_) / static_cast<double>(log_bytes_));
}

void LogInputs::NoteChannel(const std::string& channel) {
  if (channels_.contains(channel)) return;
  if (channels_.size() < kMaxChannelsNamed) {
    channels_.insert(channel);
  } else {
    has_more_channels_ = true;
  }
}

std::string LogInputs::ChannelsSeen() const {
  std::string text;
  for (const std::string& channel : channels_) {
    text += (text.empty() ? "" : ", ") + io::Quoted(channel);
  }
  if (text.empty()) return "none";
  return has_more_channels_ ? text + ", ..." : text;
}

}  // namespace clearway::replay

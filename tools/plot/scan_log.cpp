// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/scan_log.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "common/io/lcm_log.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/pose.hpp"

namespace clearway::plot {
namespace {

namespace channels = messages::channels;

// Permits and poses that belong to a scan may be logged a little after its last message.
constexpr double kLinger_us = 200e3;

// Stamp of the end of the scan that a message belongs to.
std::int64_t EndOf(const lidar_points_t& message) {
  return message.scan_end_utime;
}
template <typename Message>
std::int64_t EndOf(const Message& message) {
  return message.utime;
}

// Calls take(message) when the event is on the channel and holds its type.
template <typename Message, typename Take>
bool TakeIfOn(const messages::Channel<Message>& channel,
              const std::string& prefix,
              const io::LogEvent& event,
              const Take& take) {
  if (event.channel != prefix + channel.name) return false;
  if (const auto message = messages::Decode<Message>(event.bytes)) take(*message);
  return true;
}

// Calls take(message) when the event is a message that belongs to one scan and tells which.
template <typename Take>
bool TakeOfScan(const std::string& prefix, const io::LogEvent& event, const Take& take) {
  return TakeIfOn(channels::kLidarPoints, prefix, event, take) ||
         TakeIfOn(channels::kObstaclePoints, prefix, event, take) ||
         TakeIfOn(channels::kRemovedPoints, prefix, event, take) ||
         TakeIfOn(channels::kFloor, prefix, event, take) ||
         TakeIfOn(channels::kDetections, prefix, event, take);
}

std::string Seconds(double seconds) {
  std::string text = std::to_string(seconds);
  text.resize(text.find('.') + 3);
  return text + " s";
}

class ScanReader {
 public:
  ScanReader(const std::vector<ScanEntry>& wanted,
             const core::PoseBufferConfig& pose,
             const std::function<void(const LoggedScan&)>& take)
      : poses_(pose), take_(take) {
    for (const ScanEntry& entry : wanted) wanted_.emplace(entry.end_utime, entry);
  }

  void Take(const std::string& prefix, const io::LogEvent& event) {
    HandOnBefore(event.utime);
    TakeOfScan(prefix, event, [this](const auto& message) { AddToScan(message); }) ||
        TakeIfOn(channels::kDrivePermit,
                 prefix,
                 event,
                 [this](const auto& message) { AddPermit(message); }) ||
        TakeIfOn(channels::kMap, prefix, event, [this](const auto& tile) { map_.Add(tile); }) ||
        TakeIfOn(channels::kPose, prefix, event, [this](const auto& message) {
          poses_.Add(message.utime, messages::T_map_vehicle(message));
        });
    ++event_;
  }

  void Finish() {
    for (auto& [end_utime, scan] : open_) HandOn(end_utime, scan);
    open_.clear();
  }

 private:
  template <typename Message>
  void AddToScan(const Message& message) {
    const auto wanted = wanted_.find(EndOf(message));
    if (wanted == wanted_.end()) return;
    LoggedScan& scan = open_[wanted->first];
    scan.entry = wanted->second;
    scan.messages.Add(message);
  }

  // The permit's slice names a scan by its id: that is the newest one with it.
  void AddPermit(const drive_permit_t& message) {
    if (message.slice_scan_id < 0) return;
    permits_[message.slice_scan_id].Add(message);
    if (permits_.size() <= kMaxPermits) return;
    const bool is_oldest = permits_.begin()->first == message.slice_scan_id;
    permits_.erase(is_oldest ? std::prev(permits_.end()) : permits_.begin());
  }

  // The scans that the event to come cannot concern any more.
  void HandOnBefore(std::int64_t now_utime) {
    for (auto scan = open_.begin(); scan != open_.end();) {
      const ScanEntry& entry = scan->second.entry;
      const double since_us =
          static_cast<double>(now_utime) - static_cast<double>(entry.last_log_utime);
      const bool may_linger = since_us >= 0.0 && since_us <= kLinger_us;
      if (event_ <= entry.last_event || may_linger) {
        ++scan;
        continue;
      }
      HandOn(scan->first, scan->second);
      scan = open_.erase(scan);
    }
  }

  void HandOn(std::int64_t end_utime, LoggedScan& scan) {
    scan.messages.T_map_vehicle = poses_.Lookup(end_utime);
    const auto permit = permits_.find(scan.entry.scan_id);
    if (permit != permits_.end()) scan.messages.permit = permit->second.permit;
    scan.map = map_.Get();
    take_(scan);
  }

  static constexpr std::size_t kMaxPermits = 1000;

  std::map<std::int64_t, ScanEntry> wanted_;      // By end_utime.
  std::map<std::int64_t, LoggedScan> open_;       // Likewise.
  std::map<std::int64_t, ScanMessages> permits_;  // By scan_id.
  core::PoseBuffer poses_;
  MapCollector map_;
  const std::function<void(const LoggedScan&)>& take_;
  std::size_t event_ = 0;
};

}  // namespace

double SecondsInto(const ScanIndex& index, std::int64_t log_utime) {
  return (static_cast<double>(log_utime) - static_cast<double>(index.first_utime)) / 1e6;
}

ScanIndex IndexScans(const ScanLog& log) {
  ScanIndex index;
  index.name = log.file.string();
  std::map<std::int64_t, std::size_t> by_end;  // Position in index.scans.
  std::set<std::string> seen;
  io::LcmLogReader reader(log.file);
  std::size_t number = 0;
  for (; const std::optional<io::LogEvent> event = reader.Next(); ++number) {
    if (number == 0) index.first_utime = index.last_utime = event->utime;
    index.last_utime = std::max(index.last_utime, event->utime);
    if (seen.size() < 30) seen.insert(event->channel);
    TakeOfScan(log.channel_prefix, *event, [&](const auto& message) {
      const auto [known, is_new] = by_end.emplace(EndOf(message), index.scans.size());
      if (is_new) {
        index.scans.push_back({.scan_id = message.scan_id,
                               .end_utime = EndOf(message),
                               .first_log_utime = event->utime});
      }
      ScanEntry& entry = index.scans[known->second];
      entry.last_log_utime = event->utime;
      entry.last_event = number;
      entry.has_detections |= event->channel == log.channel_prefix + channels::kDetections.name;
    });
  }
  if (!index.scans.empty()) return index;
  std::string text = "no scan in this log; channels in it:";
  for (const std::string& channel : seen) text += " " + channel;
  throw io::ErrorInFile(index.name, seen.empty() ? "no message in this log" : text);
}

ScanEntry ScanWithId(const ScanIndex& index, std::int64_t scan_id) {
  const auto found = std::find_if(index.scans.rbegin(), index.scans.rend(), [&](const auto& scan) {
    return scan.scan_id == scan_id;
  });
  if (found != index.scans.rend()) return *found;
  const auto [low, high] =
      std::minmax_element(index.scans.begin(), index.scans.end(), [](const auto& a, const auto& b) {
        return a.scan_id < b.scan_id;
      });
  throw io::ErrorInFile(index.name,
                        "no scan " + std::to_string(scan_id) + "; there are " +
                            std::to_string(index.scans.size()) + " scans from " +
                            std::to_string(low->scan_id) + " to " + std::to_string(high->scan_id));
}

ScanEntry ScanAtTime(const ScanIndex& index, double time_s) {
  const ScanEntry* found = nullptr;
  for (const ScanEntry& scan : index.scans) {
    if (SecondsInto(index, scan.first_log_utime) <= time_s) found = &scan;
  }
  if (found != nullptr && time_s <= SecondsInto(index, index.last_utime)) return *found;
  throw io::ErrorInFile(
      index.name,
      "no scan at " + Seconds(time_s) + "; the scans " +
          std::to_string(index.scans.front().scan_id) + " to " +
          std::to_string(index.scans.back().scan_id) + " begin from " +
          Seconds(SecondsInto(index, index.scans.front().first_log_utime)) + " to " +
          Seconds(SecondsInto(index, index.scans.back().first_log_utime)) +
          " into the log, which ends at " + Seconds(SecondsInto(index, index.last_utime)));
}

ScanEntry LastScan(const ScanIndex& index) {
  const auto found = std::find_if(index.scans.rbegin(), index.scans.rend(), [](const auto& scan) {
    return scan.has_detections;
  });
  return found != index.scans.rend() ? *found : index.scans.back();
}

std::vector<ScanEntry> EveryNthScan(const ScanIndex& index, int n) {
  std::vector<ScanEntry> scans;
  for (std::size_t i = 0; i < index.scans.size(); i += static_cast<std::size_t>(n)) {
    scans.push_back(index.scans[i]);
  }
  return scans;
}

void ReadScans(const ScanLog& log,
               const std::vector<ScanEntry>& wanted,
               const core::PoseBufferConfig& pose,
               const std::function<void(const LoggedScan&)>& take) {
  ScanReader scans(wanted, pose, take);
  io::LcmLogReader reader(log.file);
  while (const std::optional<io::LogEvent> event = reader.Next()) {
    scans.Take(log.channel_prefix, *event);
  }
  scans.Finish();
}

}  // namespace clearway::plot

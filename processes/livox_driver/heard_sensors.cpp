// SPDX-License-Identifier: BSD-3-Clause
#include "processes/livox_driver/heard_sensors.hpp"

#include <algorithm>

namespace clearway {

using core::livox::DeviceType;
using core::livox::LidarConfig;

HeardSensors::Verdict HeardSensors::Hear(const core::livox::Broadcast& body,
                                         const core::Endpoint& from,
                                         std::int64_t now_us) {
  const bool is_new = !heard_.contains(body.broadcast_code);
  if (is_new) MakeRoom();
  const auto entry = heard_.try_emplace(body.broadcast_code).first;
  Heard& heard = entry->second;
  if (is_new || now_us - heard.last_us > kSilence_us) heard.first_us = now_us;
  heard.type = body.type;
  heard.from = from;
  heard.last_us = now_us;
  return {LidarOf(*entry), is_new};
}

void HeardSensors::MakeRoom() {
  if (heard_.size() < kMaxHeard) return;
  heard_.erase(std::min_element(heard_.begin(), heard_.end(), [](const auto& a, const auto& b) {
    return a.second.last_us < b.second.last_us;
  }));
}

// The lidar whose code or address names this sensor, whatever it is.
std::optional<std::size_t> HeardSensors::ClaimOf(const Entry& entry) const {
  const auto find = [this](const auto& is_it) -> std::optional<std::size_t> {
    const auto found = std::find_if(lidars_.begin(), lidars_.end(), is_it);
    if (found == lidars_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - lidars_.begin());
  };
  const auto by_code =
      find([&](const LidarConfig& lidar) { return lidar.broadcast_code == entry.first; });
  if (by_code) return by_code;
  return find([&](const LidarConfig& lidar) {
    return lidar.broadcast_code.empty() && !lidar.ip.empty() &&
           core::ParseIpv4(lidar.ip) == entry.second.from.ip;
  });
}

std::optional<std::size_t> HeardSensors::OpenLidar() const {
  const auto open = std::find_if(lidars_.begin(), lidars_.end(), [](const LidarConfig& lidar) {
    return lidar.broadcast_code.empty() && lidar.ip.empty();
  });
  if (open == lidars_.end()) return std::nullopt;
  return static_cast<std::size_t>(open - lidars_.begin());
}

std::optional<std::size_t> HeardSensors::LidarOf(const Entry& entry) const {
  if (entry.second.type != DeviceType::kMid70) return std::nullopt;
  if (const auto claimed = ClaimOf(entry)) return claimed;
  return entry.first == chosen_code_ ? OpenLidar() : std::nullopt;
}

// The MID-70s that the lidar with neither code nor address could be.
std::vector<const HeardSensors::Entry*> HeardSensors::Candidates(std::int64_t now_us) const {
  std::vector<const Entry*> candidates;
  for (const Entry& entry : heard_) {
    const bool is_there = now_us - entry.second.last_us <= kSilence_us;
    if (is_there && entry.second.type == DeviceType::kMid70 && !ClaimOf(entry)) {
      candidates.push_back(&entry);
    }
  }
  return candidates;
}

std::optional<HeardSensors::Choice> HeardSensors::Choose(std::int64_t now_us) {
  const std::optional<std::size_t> open = OpenLidar();
  if (!open || !chosen_code_.empty()) return std::nullopt;
  const std::vector<const Entry*> candidates = Candidates(now_us);
  if (candidates.size() != 1) return std::nullopt;
  const auto& [code, heard] = *candidates.front();
  if (now_us - heard.first_us < kDecide_us) return std::nullopt;
  chosen_code_ = code;
  return Choice{*open, heard.from};
}

std::string HeardSensors::TextOf(const Entry& entry) {
  return std::string(core::livox::DeviceName(entry.second.type)) + ' ' + entry.first + " at " +
         core::ToString(entry.second.from.ip);
}

std::string HeardSensors::ProblemOf(std::size_t lidar, std::int64_t now_us) const {
  for (const Entry& entry : heard_) {
    const bool is_there = now_us - entry.second.last_us <= kSilence_us;
    if (is_there && ClaimOf(entry) == lidar && entry.second.type != DeviceType::kMid70) {
      return "is a " + TextOf(entry) + "; this driver speaks to MID-70s only";
    }
  }
  if (OpenLidar() != lidar || !chosen_code_.empty()) return {};
  const std::vector<const Entry*> candidates = Candidates(now_us);
  if (candidates.size() < 2) return {};
  std::string text = "several sensors could be meant (";
  for (const Entry* entry : candidates) {
    text += (entry == candidates.front() ? "" : ", ") + TextOf(*entry);
  }
  return text + "): set livox_driver.lidar.broadcast_code to the right one";
}

std::string HeardSensors::UnknownText(std::int64_t now_us) const {
  std::string text;
  for (const Entry& entry : heard_) {
    if (now_us - entry.second.last_us > kSilence_us || LidarOf(entry)) continue;
    text += (text.empty() ? "" : ", ") + TextOf(entry);
  }
  return text;
}

}  // namespace clearway

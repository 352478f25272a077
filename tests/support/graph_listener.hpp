// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <lcm/lcm-cpp.hpp>

#include "common/messages/channels.hpp"

namespace clearway::test {

/// A message and when the kernel received it, whatever this program was doing then [us since the
/// epoch].
template <typename Message>
struct Arrived {
  std::int64_t arrival_us = 0;
  Message message;
};

/// Listens to a whole graph from outside, by LCM alone.
class GraphListener {
 public:
  static constexpr std::int64_t kDeadline_us = 60'000'000;

  explicit GraphListener(const std::string& url);
  GraphListener(const GraphListener&) = delete;
  GraphListener& operator=(const GraphListener&) = delete;

  /// Listens until `done`; false when that does not come true within `timeout_us`.
  bool Await(const std::function<bool()>& done, std::int64_t timeout_us = kDeadline_us);

  [[nodiscard]] static std::int64_t NowUs();

  std::vector<Arrived<lidar_points_t>> slices;  ///< Without their points.
  std::vector<Arrived<detections_t>> detections;
  std::vector<Arrived<drive_permit_t>> permits;
  std::map<std::string, Arrived<status_t>> statuses;  ///< The newest of each process.
  std::int64_t num_messages = 0;                      ///< Of all channels; LCM's self test apart.

 private:
  void OnMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel);

  lcm::LCM lcm_;
};

}  // namespace clearway::test

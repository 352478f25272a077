// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <clearway/status_t.hpp>

#include "common/graph/graph_config.hpp"
#include "common/net/udp_network.hpp"
#include "common/process/live_runtime.hpp"
#include "processes/simulator/emulated_sensor.hpp"

namespace clearway::livox_load {

/// What came of it.
struct LoadResult {
  std::int64_t sent = 0;     ///< Data packets that left.
  std::int64_t refused = 0;  ///< That the network did not take.
  std::int64_t skipped = 0;  ///< That were not made: this program had no processor.
  std::map<std::string, std::int64_t> driver;  ///< Counts of the driver, sensors added up.
  double driver_cpu = 0.0;                     ///< Its share of one processor.
  double seconds = 0.0;                        ///< Over which that was measured.
  std::string driver_text;                     ///< How it said to be at the end.
};

/// Emulates every lidar of the configuration, 127.0.0.2 and so on, for a driver on this host that
/// has the same configuration. Their points are always the same; the load is the matter.
class LoadRun {
 public:
  /// Throws net::NetworkError where an address cannot be had.
  LoadRun(const graph::GraphConfig& config, process::LiveRuntime& runtime);

  /// Waits until the driver has points of all sensors, measures for so long, lets the last packets
  /// arrive and gives the counts of the whole time. Throws std::runtime_error when the driver is
  /// not heard or does not connect.
  [[nodiscard]] LoadResult Measure(double seconds);

 private:
  void WaitFor(const char* what, std::int64_t timeout_us, const std::function<bool()>& holds);
  [[nodiscard]] double DriverCpuSeconds() const;

  process::LiveRuntime& runtime_;
  net::UdpNetwork network_;
  std::vector<std::unique_ptr<EmulatedSensor>> sensors_;
  std::optional<status_t> status_;  // The driver's newest.
};

}  // namespace clearway::livox_load

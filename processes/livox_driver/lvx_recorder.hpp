// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/core/livox/driver_config.hpp"
#include "common/core/vehicle.hpp"
#include "common/io/lvx/lvx_writer.hpp"
#include "common/net/datagrams.hpp"

namespace clearway {

/// Writes the packets of all sensors, as they came, into an LVX 1.1 file. What goes wrong ends the
/// recording, never the driver.
class LvxRecorder {
 public:
  /// Throws std::runtime_error when the file cannot be begun.
  LvxRecorder(const std::filesystem::path& file,
              const core::livox::DriverConfig& config,
              const core::VehicleConfig& vehicle);

  void Add(std::size_t lidar, const net::Datagram& datagram);

  /// Ends the file. @returns false when it is not whole.
  bool Close();

  [[nodiscard]] std::int64_t packages() const { return packages_; }
  /// Why the recording ended before its time; empty: it did not.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  void Fail(const std::string& why);

  std::optional<io::LvxWriter> writer_;
  std::int64_t packages_ = 0;
  std::string problem_;
};

}  // namespace clearway

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "tools/doctor/finding.hpp"
#include "tools/doctor/report.hpp"

namespace clearway::doctor {

/// The command line.
struct Arguments {
  std::filesystem::path config;
  std::filesystem::path deployment;
  std::filesystem::path host_file;
  std::string deputy;
  std::string lcm_url;
  std::string sensor_subnet = "192.168.1.0/24";
  bool wants_sensor = false;  ///< --sensor-subnet was given.
  std::string user = "clearway";
  std::int64_t listen_ms = 1500;
};

struct Result {
  Patient patient;
  Findings findings;
};

/// All checks, in the order in which things are to be mended.
[[nodiscard]] Result Examine(const Arguments& arguments);

}  // namespace clearway::doctor

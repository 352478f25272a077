// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/process/buses_config.hpp"

namespace clearway::test {

/// A bus of a test's own: LCM 1.3.1 separates buses by port.
inline std::string TestUrl(int port) {
  return "udpm://239.255.76.67:" + std::to_string(port);
}

/// Both buses on one port.
inline process::BusesConfig TestBuses(int port) {
  process::BusesConfig buses;
  buses.local.url = buses.shared.url = TestUrl(port);
  return buses;
}

/// True when the programs are slowed down by instruments.
inline constexpr bool kIsSanitized =
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(undefined_behavior_sanitizer)
    true;
#else
    false;
#endif
#else
    false;
#endif

}  // namespace clearway::test

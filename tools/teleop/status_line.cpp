// SPDX-License-Identifier: BSD-3-Clause
#include "tools/teleop/status_line.hpp"

#include <array>
#include <cstdio>

namespace clearway::teleop {
namespace {

std::string Fixed(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f", value);
  return text.data();
}

std::string Printable(const std::string& text) {
  std::string printable = text;
  for (char& c : printable) {
    if (c < ' ' || c > '~') c = '?';
  }
  return printable;
}

std::string CauseText(const drive_permit_t& permit) {
  std::string text;
  if (permit.free_distance_m >= 0.0) text += ", " + Fixed(permit.free_distance_m) + " m ahead";
  if (permit.cause_utime != 0) {
    text += ", cause at (" + Fixed(permit.cause[0]) + ", " + Fixed(permit.cause[1]) + ")";
  }
  return text;
}

}  // namespace

std::string StatusLine(const core::BaseMotion& wish,
                       core::GateState permit_state,
                       const drive_permit_t& permit,
                       std::size_t width) {
  std::string line = "wish " + Fixed(wish.v_mps) + " m/s " + Fixed(wish.w_radps) + " rad/s | ";
  if (permit_state != core::GateState::kValid) {
    line += std::string("STOP: the permit ") + core::GateText(permit_state);
  } else {
    line += "permit " + Fixed(permit.forward_mps) + " m/s";
    if (permit.forward_mps == 0.0) {
      line += ", back " + Fixed(permit.backward_mps) + ", turn " + Fixed(permit.turn_left_radps) +
              '/' + Fixed(permit.turn_right_radps);
    }
    line += ": " + Printable(permit.text) + CauseText(permit);
  }
  return line.substr(0, width);
}

}  // namespace clearway::teleop

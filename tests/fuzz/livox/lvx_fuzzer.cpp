// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as an LVX file: refused with one line, or packages that are data packets of listed
// devices, each within the file and behind the one before.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "common/io/lvx/lvx_reader.hpp"

namespace {

void Require(bool holds) {
  if (!holds) std::abort();
}

void RequireMessage(std::string_view message) {
  Require(message.substr(0, 9) == "fuzz.lvx:");
  for (const char letter : message) Require(letter >= ' ' && letter <= '~');
}

void Walk(clearway::io::LvxReader& reader) {
  std::uint64_t end = 0;
  std::int64_t packages = 0;
  while (const auto package = reader.Next()) {
    Require(package->byte >= end && package->number == packages++);
    Require(reader.DeviceWithIndex(package->device_index) != nullptr);
    const auto parsed = clearway::core::livox::ParsePacket(package->packet).packet;
    Require(parsed && parsed->shots == parsed->layout.shots_in_packet);
    end = reader.position();
    Require(end > package->byte && end <= reader.size());
  }
  const clearway::io::LvxReport& report = reader.report();
  Require(report.packages == packages && report.lost_bytes <= reader.size());
  Require(reader.position() == reader.size());
  Require(report.cut_at.has_value() == !report.cut.empty());
  if (report.cut_at) RequireMessage(report.cut);
  const bool has_problem =
      report.damages > 0 || report.foreign_types > 0 || report.unknown_devices > 0;
  Require(has_problem == !report.first_problem.empty());
  if (has_problem) RequireMessage(report.first_problem);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    clearway::io::LvxReader reader(std::string(reinterpret_cast<const char*>(data), size),
                                   "fuzz.lvx");
    Walk(reader);
  } catch (const clearway::io::ReadError& error) {
    RequireMessage(error.what());
  }
  return 0;
}

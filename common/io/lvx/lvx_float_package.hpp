// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "common/core/livox/data_packet.hpp"
#include "common/io/lvx/lvx_format.hpp"

namespace clearway::io::lvx {

/// A package of version 1.0.
struct FloatPackage {
  std::array<core::livox::Point, kFloatPoints> points{};  ///< As the file has them.
  core::livox::Bytes packet;  ///< The same as a packet of type 0, rounded to millimetres.
};

/// Takes a package of version 1.0 apart. What the wire cannot say (NaN, beyond 2,147 km) is no
/// return in `packet`. @pre `package` holds one, its head included.
[[nodiscard]] FloatPackage ConvertFloatPackage(core::livox::ByteView package);

}  // namespace clearway::io::lvx

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace clearway::io {

/// The stamp that a file is named after [us since the epoch], exactly, what is below a microsecond
/// cut off. `stem` is the name without folder and extension; the stamp is all of it, or what
/// follows its last '_' (`vlp16_1673400472138016708`). It is one of
/// - seconds: 1 to 12 digits, a point, 1 to 18 digits (`1744500470.786466599`);
/// - microseconds: 14 to 16 digits (`1744500470786466`);
/// - nanoseconds: 17 to 19 digits (`1744500470786466599`).
/// Nothing else is a stamp: fewer digits are frame numbers (KITTI's have 6 or 10).
[[nodiscard]] std::optional<std::int64_t> ParseScanStamp(std::string_view stem);

}  // namespace clearway::io

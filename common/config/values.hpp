// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

/// Text of attributes <-> values. All of it is independent of the locale.
///
/// Numbers are decimal, with an optional '-' and, for real numbers, an optional exponent. A leading
/// '+', white space, hexadecimal digits, "nan", "inf" and anything behind the number are refused.
namespace clearway::config::internal {

/// Empty when the text is not a finite number that a double can hold. "-0" gives 0.
[[nodiscard]] std::optional<double> ParseNumber(std::string_view text);

/// Empty when the text is not a whole number that an int can hold ("1.0" is not one).
[[nodiscard]] std::optional<int> ParseInteger(std::string_view text);

/// Milliseconds -> microseconds. Empty when the text is no number, finer than a
/// microsecond or beyond 1e12 ms.
[[nodiscard]] std::optional<std::int64_t> ParseMilliseconds(std::string_view text);

/// Shortest text that ParseNumber() turns into the same value.
[[nodiscard]] std::string FormatNumber(double value);
[[nodiscard]] std::string FormatMilliseconds(std::int64_t time_us);

/// Shortest degrees that mean these radians. A text of at most 9 digits within 2 units in the last
/// place is taken as the one that was meant (pi / 12 is "15"); else the one that gives exactly this
/// value, or, where no double in degrees does, the nearest.
[[nodiscard]] std::string FormatDegrees(double angle_rad);

/// The one place where degrees become radians.
[[nodiscard]] double RadFromDeg(double angle_deg);

/// As RadFromDeg(), or up to 2 units in the last place beside it: the radians that FormatDegrees()
/// and RadFromDeg() lead back to exactly.
[[nodiscard]] double ToCanonicalRad(double angle_deg);

/// True when the text holds no control character.
[[nodiscard]] bool IsPlainText(std::string_view text);

/// `a "b"` <-> `"a \"b\""`. Unquote() is empty when the text is no complete quoted text.
[[nodiscard]] std::string Quote(std::string_view text);
[[nodiscard]] std::optional<std::string> Unquote(std::string_view text);

/// What a message shows of a text from outside: one line, control characters as \xNN, cut when
/// long.
[[nodiscard]] std::string Shown(std::string_view text);

/// All parts in one text. Stands where GCC 12 would warn without cause about `"a" + std::string()`
/// (-Wrestrict, GCC bug 105651).
[[nodiscard]] std::string Concat(std::initializer_list<std::string_view> parts);

/// Without blanks, tabs, carriage returns and line feeds at both ends.
[[nodiscard]] std::string_view Trim(std::string_view text);

}  // namespace clearway::config::internal

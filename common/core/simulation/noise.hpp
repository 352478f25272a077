// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace clearway::core {

/// Scrambles 64 bits; every output belongs to exactly one input.
/// Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014 (SplitMix64).
[[nodiscard]] constexpr std::uint64_t SplitMix64(std::uint64_t value) {
  value += 0x9E3779B97F4A7C15ULL;
  value = (value ^ (value >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  value = (value ^ (value >> 27U)) * 0x94D049BB133111EBULL;
  return value ^ (value >> 31U);
}

/// A number of the standard normal distribution for each pair (seed, counter): no state, any order,
/// and the same on every standard library, which std::normal_distribution is not.
/// Source: Box and Muller, 1958.
[[nodiscard]] inline double NormalNoise(std::uint64_t seed, std::uint64_t counter) {
  constexpr double kUnit = 0x1.0p-53;
  const std::uint64_t first = SplitMix64(SplitMix64(seed) ^ counter);
  const std::uint64_t second = SplitMix64(first);
  const double u = (static_cast<double>(first >> 11U) + 0.5) * kUnit;
  const double v = static_cast<double>(second >> 11U) * kUnit;
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

}  // namespace clearway::core

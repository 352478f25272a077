// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/mid70_pattern.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace clearway::core {

Eigen::Vector3d Mid70Direction(std::int64_t shot) {
  constexpr std::int64_t kShotsPerPattern = 3'000'000;
  constexpr double kTurnsPerShot1 = -4664.0 / 60.0 * 1e-5;
  constexpr double kTurnsPerShot2 = 7294.0 / 60.0 * 1e-5;
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  const auto k = static_cast<double>((shot + 1) % kShotsPerPattern);

  // e(p, q) = e(1, 0)^p e(0, 1)^q: two pointers are computed, the others are their products.
  const std::complex<double> e1 = std::polar(1.0, kTurn_rad * kTurnsPerShot1 * k);
  const std::complex<double> e2 = std::polar(1.0, kTurn_rad * kTurnsPerShot2 * k);
  const std::complex<double> step = e1 * std::conj(e2);
  const std::complex<double> w =
      -(0.298995 * e1 + 0.286091 * e2 + 0.020277 * (e1 * step) + 0.006169 * (e2 * std::conj(step)) +
        0.002022 * (e1 * step * step) + 0.000674 * (e2 * std::conj(step * step)));
  const double theta = std::abs(w);
  const double scale = theta > 0.0 ? std::sin(theta) / theta : 1.0;
  return {std::cos(theta), scale * w.real(), scale * w.imag()};
}

}  // namespace clearway::core

// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/mid70_pattern.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace clearway::core {
namespace {

using Complex = std::complex<double>;

// Shots of 10 us in a minute: prism speeds in rpm are whole steps of this circle.
constexpr std::int64_t kCircle = 6'000'000;
constexpr std::int64_t kShotsPerPattern = 3'000'000;
constexpr std::int64_t kRpm1 = -4664;
constexpr std::int64_t kRpm2 = 7294;
constexpr std::int64_t kFine = 2500;
constexpr std::int64_t kCoarse = kCircle / kFine;

// Unit pointers at every step of the circle, as the product of a coarse and a fine one: the same
// for a shot however it is asked for, and without trigonometry.
class Circle {
 public:
  Circle() {
    for (std::int64_t i = 0; i < kCoarse; ++i) {
      coarse_[static_cast<std::size_t>(i)] = Pointer(i * kFine);
    }
    for (std::int64_t i = 0; i < kFine; ++i) fine_[static_cast<std::size_t>(i)] = Pointer(i);
  }

  [[nodiscard]] Complex At(std::int64_t step) const {
    std::int64_t place = step % kCircle;
    if (place < 0) place += kCircle;
    return Product(coarse_[static_cast<std::size_t>(place / kFine)],
                   fine_[static_cast<std::size_t>(place % kFine)]);
  }

  // Without the checks for infinities that std::complex makes.
  [[nodiscard]] static Complex Product(const Complex& a, const Complex& b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
  }

 private:
  static Complex Pointer(std::int64_t step) {
    return std::polar(
        1.0, 2.0 * std::numbers::pi * static_cast<double>(step) / static_cast<double>(kCircle));
  }

  std::array<Complex, kCoarse> coarse_{};
  std::array<Complex, kFine> fine_{};
};

// cos(a) and sin(a) / a as power series in a^2, exact to 1e-16 for a below 0.7.
struct CosAndSinc {
  double cosine;
  double sinc;
};
CosAndSinc SeriesOf(double a2) {
  const double cosine =
      1.0 +
      a2 * (-1.0 / 2.0 +
            a2 * (1.0 / 24.0 +
                  a2 * (-1.0 / 720.0 + a2 * (1.0 / 40320.0 +
                                             a2 * (-1.0 / 3628800.0 + a2 * (1.0 / 479001600.0))))));
  const double sinc =
      1.0 +
      a2 * (-1.0 / 6.0 +
            a2 * (1.0 / 120.0 +
                  a2 * (-1.0 / 5040.0 + a2 * (1.0 / 362880.0 + a2 * (-1.0 / 39916800.0 +
                                                                     a2 * (1.0 / 6227020800.0))))));
  return {cosine, sinc};
}

}  // namespace

Eigen::Vector3d Mid70Direction(std::int64_t shot) {
  static const Circle kCirclePointers;
  const std::int64_t k = (shot + 1) % kShotsPerPattern;
  const Complex e1 = kCirclePointers.At(kRpm1 * k);
  const Complex e2 = kCirclePointers.At(kRpm2 * k);
  // e(p, q) = e(1, 0)^p e(0, 1)^q: two pointers are looked up, the others are their products.
  const Complex step = Circle::Product(e1, std::conj(e2));
  const Complex step2 = Circle::Product(step, step);
  const Complex w =
      -(0.298995 * e1 + 0.286091 * e2 + 0.020277 * Circle::Product(e1, step) +
        0.006169 * Circle::Product(e2, std::conj(step)) + 0.002022 * Circle::Product(e1, step2) +
        0.000674 * Circle::Product(e2, std::conj(step2)));
  // The off-axis angle is |w|.
  const CosAndSinc series = SeriesOf(w.real() * w.real() + w.imag() * w.imag());
  return {series.cosine, series.sinc * w.real(), series.sinc * w.imag()};
}

}  // namespace clearway::core

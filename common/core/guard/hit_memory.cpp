// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/hit_memory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clearway::core {

HitMemory::HitMemory(const SweptFootprint& footprint, double reach_m, int min_points)
    : footprint_(footprint),
      reach_m_(reach_m),
      min_points_(std::min(min_points, kMaxAgreeing)),
      side_(0) {
  // Two cells with the same place in the wrapped square are further apart than any two hits that
  // are kept: reach both ways, and as much again for what is left behind while it is held.
  const double radius_m =
      std::max(footprint_.half_length_m() + reach_m, footprint_.turn_radius_m());
  side_ = static_cast<std::int64_t>(std::ceil(3.0 * radius_m / kCell_m)) + 4;
  cells_.resize(static_cast<std::size_t>(side_ * side_));
  listed_.reserve(cells_.size());
}

void HitMemory::Clear() {
  for (const std::size_t index : listed_) cells_[index] = Cell();
  listed_.clear();
}

void HitMemory::Move(double forward_m, double turn_rad) {
  // The chord of the arc, at half the turn.
  const double half = 0.5 * turn_rad;
  const double chord_m = std::abs(half) < 1e-6 ? forward_m : forward_m * std::sin(half) / half;
  position_own_ += chord_m * Eigen::Vector2d(std::cos(heading_own_rad_ + half),
                                             std::sin(heading_own_rad_ + half));
  heading_own_rad_ = std::remainder(heading_own_rad_ + turn_rad, 2.0 * std::numbers::pi);
}

Eigen::Vector2d HitMemory::ToOwn(const Eigen::Vector2d& p) const {
  const double c = std::cos(heading_own_rad_);
  const double s = std::sin(heading_own_rad_);
  return position_own_ + Eigen::Vector2d(c * p.x() - s * p.y(), s * p.x() + c * p.y());
}

Eigen::Vector2d HitMemory::ToVehicle(const Eigen::Vector2d& p) const {
  const double c = std::cos(heading_own_rad_);
  const double s = std::sin(heading_own_rad_);
  const Eigen::Vector2d d = p - position_own_;
  return {c * d.x() + s * d.y(), -s * d.x() + c * d.y()};
}

std::size_t HitMemory::IndexOf(std::int64_t cx, std::int64_t cy) const {
  const std::int64_t column = ((cx % side_) + side_) % side_;
  const std::int64_t row = ((cy % side_) + side_) % side_;
  return static_cast<std::size_t>(row * side_ + column);
}

void HitMemory::Add(const Eigen::Vector3f& point_vehicle, std::int64_t clock_us) {
  const Eigen::Vector2d point = point_vehicle.head<2>().cast<double>();
  FreeWay way = footprint_.WayTo(point);
  for (const Direction d : {Direction::kForward, Direction::kBackward}) {
    double& straight = way[static_cast<std::size_t>(d)];
    if (straight > reach_m_) straight = std::numeric_limits<double>::infinity();
  }
  if (std::all_of(way.begin(), way.end(), [](double w) { return std::isinf(w); })) return;

  const Eigen::Vector2d own = ToOwn(point);
  const auto cx = static_cast<std::int64_t>(std::floor(own.x() / kCell_m));
  const auto cy = static_cast<std::int64_t>(std::floor(own.y() / kCell_m));
  const std::size_t index = IndexOf(cx, cy);
  Cell& cell = cells_[index];
  if (!cell.is_listed || cell.cx != cx || cell.cy != cy) {
    const bool was_listed = cell.is_listed;
    cell = Cell();
    cell.cx = cx;
    cell.cy = cy;
    cell.is_listed = true;
    if (!was_listed) listed_.push_back(index);
  }
  cell.recent[cell.next_recent] = clock_us;
  cell.next_recent = (cell.next_recent + 1) % cell.recent.size();
  for (std::size_t d = 0; d < kNumDirections; ++d) {
    if (std::isinf(way[d])) continue;
    cell.latest[d] = {own, point_vehicle.z(), way[d], clock_us};
    if (way[d] <= cell.best[d].way) cell.best[d] = cell.latest[d];
  }
}

int HitMemory::CountAround(const Cell& cell, std::int64_t oldest_us) const {
  int count = 0;
  for (std::int64_t dy = -1; dy <= 1; ++dy) {
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      const Cell& other = cells_[IndexOf(cell.cx + dx, cell.cy + dy)];
      if (!other.is_listed || other.cx != cell.cx + dx || other.cy != cell.cy + dy) continue;
      for (const std::int64_t us : other.recent) count += us >= oldest_us ? 1 : 0;
    }
  }
  return count;
}

void HitMemory::Expire(std::int64_t oldest_us) {
  std::erase_if(listed_, [&](std::size_t index) {
    Cell& cell = cells_[index];
    const bool is_over = std::all_of(
        cell.recent.begin(), cell.recent.end(), [&](std::int64_t us) { return us < oldest_us; });
    if (is_over) {
      cell = Cell();
      return true;
    }
    for (std::size_t d = 0; d < kNumDirections; ++d) {
      if (cell.latest[d].clock_us < oldest_us) cell.latest[d] = Hit();
      if (cell.best[d].clock_us < oldest_us) cell.best[d] = cell.latest[d];
    }
    return false;
  });
}

void HitMemory::TakeNearest(const Cell& cell,
                            std::array<NearestHit, kNumDirections>& nearest) const {
  for (const auto* hits : {&cell.best, &cell.latest}) {
    for (const Hit& hit : *hits) {
      if (hit.clock_us == kNever) continue;
      const Eigen::Vector2d point = ToVehicle(hit.position_own);
      const FreeWay way = footprint_.WayTo(point);
      for (std::size_t d = 0; d < kNumDirections; ++d) {
        if (way[d] >= nearest[d].way) continue;
        nearest[d] = {way[d],
                      {static_cast<float>(point.x()), static_cast<float>(point.y()), hit.z_m}};
      }
    }
  }
}

std::array<NearestHit, kNumDirections> HitMemory::Nearest(std::int64_t clock_us,
                                                          std::int64_t hold_us) {
  const std::int64_t oldest_us = clock_us - hold_us;
  Expire(oldest_us);
  std::array<NearestHit, kNumDirections> nearest;
  for (const std::size_t index : listed_) {
    const Cell& cell = cells_[index];
    if (CountAround(cell, oldest_us) >= min_points_) TakeNearest(cell, nearest);
  }
  return nearest;
}

}  // namespace clearway::core

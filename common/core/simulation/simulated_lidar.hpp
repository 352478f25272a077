// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Geometry>

#include "common/core/livox/commands.hpp"
#include "common/core/livox/data_packet.hpp"
#include "common/core/simulation/lidar_scan.hpp"
#include "common/core/simulation/world.hpp"

namespace clearway::core {

/// An echo of a shot as the sensor measures it; all zero when there was none.
struct SimulatedEcho {
  livox::WirePoint point_sensor;    ///< Frame sensor.
  std::int32_t object = kNoObject;  ///< What it lies on: an object, kFloorObject, kMapObject,
                                    ///< kDustObject or kNoObject.
};

/// The echoes of a shot: the nearest one first; the second one only in dual mode, where the beam
/// met an edge.
struct SimulatedShot {
  std::array<SimulatedEcho, 2> echoes;
};

/// Bits 5-4 of a tag: the number of the echo. Bits 3-2: 1 where the intensity looks like rain, fog
/// or dust. Bits 1-0: 1 where the place looks like noise. Near objects are number 0, as the head's
/// own echo is (the vendor's manual, p. 16); where exactly that ends is not known.
inline constexpr std::uint8_t kFirstEchoTag = 0x10;
inline constexpr std::uint8_t kSecondEchoTag = 0x20;
inline constexpr std::uint8_t kDustTag = 0x04;
inline constexpr std::uint8_t kMirrorTag = 0x01;
inline constexpr double kNearEcho_m = 1.5;

/// A MID-70 in a world. Same seed, world, poses and shots: same echoes, however the shots are
/// batched.
///
/// Range noise is normal; a return needs reflectivity and angle of incidence that suffice at its
/// range (SimulatedLidarConfig), and nearer ones than min_range_m give none and hide what is behind
/// them. Glass is passed through, but for a glint where it is met head-on. A glossy surface shows
/// what it mirrors, as far behind it as the light went on, at half the intensity; where the mirror
/// shows nothing, its own surface, dimly. In dust a shot returns at a random depth, by the way that
/// it goes through it. The beam has no width except in dual mode, where a second ray at its corner
/// (0.14 deg beside and 0.015 deg above it) finds the second echo when it differs by more than 0.2
/// m. First and strongest return are the same here: no shot has a weaker echo before a stronger
/// one.
class SimulatedLidar {
 public:
  SimulatedLidar(const SimulatedLidarConfig& config, std::uint64_t seed);

  /// Fires shots first_shot, first_shot + 1, ... (their directions: Mid70Direction()), one for each
  /// element of `shots`, all from T_map_sensor into the world as it is at `time_us` after the
  /// scene's start. Allocates nothing once sizes have settled. O(shots * solids in view).
  /// @pre first_shot >= 0, time_us >= 0.
  void Fire(World& world,
            std::int64_t time_us,
            const Eigen::Isometry3d& T_map_sensor,
            std::int64_t first_shot,
            livox::ReturnMode mode,
            std::span<SimulatedShot> shots) const;

 private:
  /// What one ray comes to.
  struct Return {
    double range_m = 0.0;  // 0: nothing comes back.
    double brightness = 0.0;
    std::int32_t object = kNoObject;
    std::uint8_t tag = 0;
  };

  [[nodiscard]] Return Trace(const World& world, const Eigen::Vector3d& direction_map) const;
  [[nodiscard]] Return Mirrored(const World& world,
                                const RayHit& hit,
                                const Eigen::Vector3d& direction_map) const;
  [[nodiscard]] Return Dusted(const World& world,
                              const Return& behind,
                              const Eigen::Vector3d& direction_map,
                              std::int64_t shot) const;
  [[nodiscard]] Return Judged(const RayHit& hit) const;
  [[nodiscard]] SimulatedEcho EchoOf(const Return& found,
                                     const Eigen::Vector3d& direction_sensor,
                                     std::uint64_t noise_counter) const;

  SimulatedLidarConfig config_;
  std::uint64_t seed_;
  mutable Eigen::Vector3d origin_map_ = Eigen::Vector3d::Zero();
  mutable double time_s_ = 0.0;
};

}  // namespace clearway::core

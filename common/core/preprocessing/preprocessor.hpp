// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/core/cloud.hpp"
#include "common/core/geometry/pose_buffer.hpp"
#include "common/core/mapping/local_map.hpp"
#include "common/core/mapping/map_filter.hpp"
#include "common/core/perception/backend.hpp"
#include "common/core/perception/floor/floor_finder.hpp"
#include "common/core/perception/floor/floor_tracker.hpp"
#include "common/core/perception/voxel/voxel_grid.hpp"
#include "common/core/scan/scan_assembler.hpp"
#include "common/core/vehicle.hpp"

namespace clearway::core {

class MotionTrack;

/// Which returns are dropped for what the sensor's own tag says about them (Livox: bits 3-2 by
/// intensity, bits 1-0 by position; 1 = noise with high confidence, 2 = moderate, 3 = low).
enum class NoiseFilter : std::int8_t {
  kOff,      ///< None.
  kCertain,  ///< High confidence.
  kLikely,   ///< High and moderate confidence.
};
inline constexpr std::array<std::pair<const char*, NoiseFilter>, 3> kNoiseFilterNames{
    {{"off", NoiseFilter::kOff},
     {"certain", NoiseFilter::kCertain},
     {"likely", NoiseFilter::kLikely}}};

/// Settings of Preprocessor. XML element: <preprocessor>.
struct PreprocessorConfig {
  Backend backend = kBackendNames.front().second;
  NoiseFilter drop_noise = NoiseFilter::kOff;
  BoxConfig crop_box = {-30.0, 30.0, -30.0, 30.0, -1.5, 2.5};
  std::vector<BoxConfig> exclusion_zones;
  VoxelGridConfig voxel_grid;
  FloorConfig floor;
  ScanAssemblerConfig assembler;
  PoseBufferConfig odometry;
  PoseBufferConfig pose;
  MapFilterConfig map_filter;
  LocalMapConfig local_map;
  bool removed_points = false;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Choice(
        "backend", self.backend, kBackendNames, "Implementation of voxel grid and floor.");
    visitor.Choice("drop_noise",
                   self.drop_noise,
                   kNoiseFilterNames,
                   "Drops returns that the sensor tags as noise. Helps in dust, rain and fog; may "
                   "cost thin and dark objects.");
    visitor.Group("crop_box",
                  self.crop_box,
                  "What lies outside is left out; frame vehicle. Reach below the floor by the "
                  "deepest hole to be seen.");
    visitor.List("exclusion_zone",
                 self.exclusion_zones,
                 "What lies inside is left out; frame vehicle. The stop guard does not know these "
                 "zones: it goes on seeing what is there.");
    visitor.Group("voxel_grid", self.voxel_grid, "Reduction of the points.");
    visitor.Group("floor", self.floor, "Search for the floor.");
    visitor.Group("assembler", self.assembler, "How slices become scans.");
    visitor.Group("odometry", self.odometry, "How ODOMETRY is interpolated.");
    visitor.Group("pose", self.pose, "How POSE is interpolated.");
    visitor.Group("map_filter", self.map_filter, "Removal of what the static map explains.");
    visitor.Group("local_map", self.local_map, "What each scan saw of its surroundings.");
    visitor.Flag("removed_points",
                 self.removed_points,
                 "Publishes REMOVED_POINTS: what was taken out, and why. For viewers; nothing in "
                 "the graph needs it.");
  }
};

/// How the points of a scan were brought to one time. The values are those of the wire.
enum class DeskewState : std::int8_t {
  kStationary = 0,  ///< The vehicle stands still by its configuration.
  kDeskewed = 1,    ///< By odometry; PreprocessedScan::num_undeskewed tells how many were not.
  kNoOdometry = 2,  ///< The pose at the scan's end is missing: all points as they were measured.
};

/// What the map filter did with a scan. The values are those of the wire.
enum class MapState : std::int8_t {
  kOff = 0,         ///< Not configured.
  kFiltered = 1,    ///< Points that the map explains were taken out.
  kNoMap = 2,       ///< Nothing was taken out: no map.
  kNoPose = 3,      ///< Nothing was taken out: no pose for the scan's end.
  kPoseOld = 4,     ///< Nothing was taken out: the newest pose is too old to be carried on.
  kPoseLost = 5,    ///< Nothing was taken out: who gives the pose says that it is lost.
  kOutsideMap = 6,  ///< Filtered, but most points lie off the map or in its unknown cells.
};

/// Why a point is in PreprocessedScan::removed_vehicle. The values are those of the wire.
enum class RemovalReason : std::int8_t { kFloor = 1, kMap = 2 };

/// What is known about where the vehicle is. Everything may be missing.
struct Surroundings {
  const PoseBuffer* odometry = nullptr;  ///< T_odom_vehicle. A stationary vehicle needs none.
  const PoseBuffer* pose = nullptr;      ///< T_map_vehicle.
  bool is_pose_lost = false;             ///< The pose is there and not to be believed.
  const StaticMap* map = nullptr;
};

/// Bits of PreprocessedScan::flags.
inline constexpr std::uint8_t kFlagBelowFloor = 1U << 0U;

/// Where the points of one scan went. in = zero + invalid + out_of_range + noise + cropped + body +
/// excluded + kept; voxels = floor + above + below; above + below = all of by_map when the map
/// filter ran.
struct PointCounts {
  std::size_t in = 0;            ///< Points in the slices.
  std::size_t zero = 0;          ///< (0, 0, 0): no return, although in the slices.
  std::size_t invalid = 0;       ///< NaN, infinite or absurdly far.
  std::size_t out_of_range = 0;  ///< Nearer than min_range_m, farther than max_range_m.
  std::size_t noise = 0;         ///< By tag.
  std::size_t cropped = 0;       ///< Outside the crop box.
  std::size_t body = 0;          ///< On the robot itself.
  std::size_t excluded = 0;      ///< In an exclusion zone.
  std::size_t kept = 0;          ///< What is left of the above.
  std::size_t sparse = 0;        ///< Of `kept`: in cells with too few points.
  std::size_t voxels = 0;        ///< Points after the voxel grid.
  std::size_t floor = 0;         ///< Of `voxels`: on the floor, removed.
  std::size_t above = 0;         ///< Of `voxels`: above the floor, kept.
  std::size_t below = 0;         ///< Of `voxels`: below the floor, kept and marked.

  /// Points off the floor by MapVerdict; zeros when the map filter did not run.
  std::array<std::size_t, kNumMapVerdicts> by_map{};
  [[nodiscard]] std::size_t OfMap(MapVerdict verdict) const {
    return by_map[static_cast<std::size_t>(verdict)];
  }
};

/// What is left of one scan.
struct PreprocessedScan {
  std::int64_t scan_id = 0;
  std::int64_t utime_start = 0;     ///< As the assembled scan.
  std::int64_t utime = 0;           ///< End of the scan: the time that all points are given for.
  PointCloud obstacles_vehicle;     ///< What is left, above the floor first; time offset 0.
  std::vector<std::uint8_t> flags;  ///< One for each point: kFlag... bits.
  MapState map_state = MapState::kOff;
  MapVersion map_version;      ///< Of the map that was filtered with; zeros when none was.
  PointCloud removed_vehicle;  ///< Floor and explained points; empty unless configured.
  std::vector<RemovalReason> removal_reasons;  ///< One for each of removed_vehicle.
  std::optional<LocalMap> local_map;  ///< Before the map filter; nothing when off or without pose.
  FloorEstimate floor;                ///< In the vehicle frame at `utime`.
  DeskewState deskew = DeskewState::kNoOdometry;
  std::size_t num_undeskewed = 0;  ///< Kept points taken as if measured at `utime`.
  PointCounts counts;
  std::int64_t shots = 0;         ///< As the slices told.
  std::int64_t zero_returns = 0;  ///< Likewise.
  bool complete = false;
  int missing_slices = 0;
  std::vector<int> missing_sensors;
};

/// From one assembled scan to the points that are neither floor nor explained by the map. In this
/// order: zero returns and defects out, range, tag; sensor -> vehicle; masks in vehicle; deskew
/// into odom at each point's time; voxel grid in odom; back to vehicle at the scan's end; floor;
/// local map; map filter with the pose at the scan's end. Nothing is dropped because a pose, the
/// map or the floor is missing: the point stays and the result says so. A scan without points gives
/// a result without points, with the same stamp. Same scans and poses in the same order, same
/// results. Thread safety: none.
class Preprocessor {
 public:
  /// @pre both configurations have been validated.
  Preprocessor(const PreprocessorConfig& config, const VehicleConfig& vehicle);
  ~Preprocessor();

  /// Sensors beyond those of the configuration are ignored.
  [[nodiscard]] PreprocessedScan Process(const AssembledScan& scan,
                                         const Surroundings& surroundings);

 private:
  struct SensorGeometry {
    Eigen::Matrix3f R_vehicle_sensor;
    Eigen::Vector3f t_vehicle_sensor;
    float min_range2_m2;
    float max_range2_m2;
  };
  struct FoundPose {
    std::optional<Eigen::Isometry3d> T_map_vehicle;
    MapState why_not = MapState::kNoPose;  // When there is none.
  };

  [[nodiscard]] bool IsNoise(std::uint8_t tag) const;
  [[nodiscard]] std::size_t PointCounts::*Fate(const SensorGeometry& sensor,
                                               const PointCloud& cloud,
                                               std::size_t i) const;
  [[nodiscard]] std::size_t PointCounts::*Mask(const Eigen::Vector3f& point_vehicle) const;
  void Collect(const AssembledScan& scan, const MotionTrack* track, PreprocessedScan& result);
  void CollectSensor(std::size_t s,
                     const SensorScan& sensor_scan,
                     const MotionTrack* track,
                     PreprocessedScan& result);
  // Gives the points on the floor.
  [[nodiscard]] PointCloud SplitFloor(const PointCloud& cloud_vehicle, PreprocessedScan& result);
  void UseMap(const Surroundings& surroundings,
              const PointCloud& floor_vehicle,
              PreprocessedScan& result);
  [[nodiscard]] FoundPose FindPose(const Surroundings& surroundings, std::int64_t utime) const;
  void ApplyMap(const StaticMap& map,
                const Eigen::Isometry3d& T_map_vehicle,
                PreprocessedScan& result);

  PreprocessorConfig config_;
  bool stationary_;
  std::vector<BoxConfig> body_;
  std::vector<SensorGeometry> sensors_;
  std::unique_ptr<VoxelGrid> voxel_grid_;
  std::unique_ptr<FloorFinder> floor_finder_;
  FloorTracker floor_tracker_;
  MapFilter map_filter_;
  LocalMapBuilder local_map_builder_;
  std::vector<Eigen::Vector3d> sensor_origins_vehicle_;
  PointCloud merged_;  // Of all sensors, in the frame of the voxel grid.
  Eigen::Isometry3d T_local_vehicle_end_ = Eigen::Isometry3d::Identity();
};

}  // namespace clearway::core

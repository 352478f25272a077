// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/preprocessing/preprocessor.hpp"

#include <algorithm>
#include <optional>

#include "common/core/perception/floor/floor_split.hpp"
#include "common/core/perception/limits.hpp"
#include "common/core/preprocessing/motion_track.hpp"

namespace clearway::core {

namespace {

PreprocessedScan Header(const AssembledScan& scan) {
  PreprocessedScan result;
  result.scan_id = scan.scan_id;
  result.utime_start = scan.utime_start;
  result.utime = scan.utime_end;
  result.shots = scan.shots;
  result.zero_returns = scan.zero_returns;
  result.complete = scan.complete;
  result.missing_slices = scan.missing_slices;
  result.missing_sensors = scan.missing_sensors;
  return result;
}

void Transform(const Eigen::Isometry3d& transform, PointCloud& cloud) {
  const Eigen::Matrix3f rotation = transform.linear().cast<float>();
  const Eigen::Vector3f translation = transform.translation().cast<float>();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f p = rotation * cloud.Point(i) + translation;
    cloud.x[i] = p.x();
    cloud.y[i] = p.y();
    cloud.z[i] = p.z();
  }
}

bool IsInAny(const std::vector<BoxConfig>& boxes, const Eigen::Vector3f& point) {
  return std::any_of(
      boxes.begin(), boxes.end(), [&](const BoxConfig& box) { return box.Contains(point); });
}

}  // namespace

Preprocessor::Preprocessor(const PreprocessorConfig& config, const VehicleConfig& vehicle)
    : config_(config),
      stationary_(vehicle.stationary),
      body_(vehicle.body),
      voxel_grid_(MakeVoxelGrid(config.backend, config.voxel_grid)),
      floor_finder_(MakeFloorFinder(config.backend, config.floor)),
      floor_tracker_(config.floor),
      map_filter_(config.map_filter, vehicle.Footprint()),
      local_map_builder_(config.local_map) {
  for (const SensorConfig& sensor : vehicle.sensors) {
    const Eigen::Isometry3d T_vehicle_sensor = sensor.T_vehicle_sensor();
    sensor_origins_vehicle_.push_back(T_vehicle_sensor.translation());
    sensors_.push_back({T_vehicle_sensor.linear().cast<float>(),
                        T_vehicle_sensor.translation().cast<float>(),
                        static_cast<float>(sensor.min_range_m * sensor.min_range_m),
                        static_cast<float>(sensor.max_range_m * sensor.max_range_m)});
  }
}

Preprocessor::~Preprocessor() = default;

PreprocessedScan Preprocessor::Process(const AssembledScan& scan,
                                       const Surroundings& surroundings) {
  const PoseBuffer* const odometry = surroundings.odometry;
  PreprocessedScan result = Header(scan);
  T_local_vehicle_end_ = Eigen::Isometry3d::Identity();
  std::optional<MotionTrack> track;
  std::optional<Eigen::Isometry3d> T_odom_vehicle_end;
  if (!stationary_ && odometry != nullptr) T_odom_vehicle_end = odometry->Lookup(scan.utime_end);
  if (T_odom_vehicle_end) {
    const Eigen::Vector3d origin_odom =
        SnapToGrid(T_odom_vehicle_end->translation(), config_.voxel_grid.leaf_m);
    T_local_vehicle_end_ = Eigen::Translation3d(-origin_odom) * *T_odom_vehicle_end;
    track.emplace(*odometry, scan.utime_start, scan.utime_end, origin_odom);
  }
  result.deskew = stationary_ ? DeskewState::kStationary
                  : track     ? DeskewState::kDeskewed
                              : DeskewState::kNoOdometry;

  Collect(scan, track ? &*track : nullptr, result);
  VoxelGrid::Result voxels = voxel_grid_->Downsample(merged_);
  result.counts.sparse = voxels.num_sparse;
  result.counts.voxels = voxels.cloud.size();
  Transform(T_local_vehicle_end_.inverse(), voxels.cloud);
  const PointCloud floor_vehicle = SplitFloor(voxels.cloud, result);
  UseMap(surroundings, floor_vehicle, result);
  if (config_.removed_points) {
    result.removed_vehicle.Append(floor_vehicle);
    result.removal_reasons.resize(result.removed_vehicle.size(), RemovalReason::kFloor);
  }
  return result;
}

void Preprocessor::Collect(const AssembledScan& scan,
                           const MotionTrack* track,
                           PreprocessedScan& result) {
  merged_.Clear();
  const std::size_t num_sensors = std::min(sensors_.size(), scan.sensors.size());
  for (std::size_t s = 0; s < num_sensors; ++s) {
    CollectSensor(s, scan.sensors[s], track, result);
  }
}

void Preprocessor::CollectSensor(std::size_t s,
                                 const SensorScan& sensor_scan,
                                 const MotionTrack* track,
                                 PreprocessedScan& result) {
  const PointCloud& cloud = sensor_scan.cloud_sensor;
  const Eigen::Isometry3f T_local_vehicle_end = T_local_vehicle_end_.cast<float>();
  result.counts.in += cloud.size();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::size_t PointCounts::*const fate = Fate(sensors_[s], cloud, i);
    ++(result.counts.*fate);
    if (fate != &PointCounts::kept) continue;
    const Eigen::Vector3f point_vehicle =
        sensors_[s].R_vehicle_sensor * cloud.Point(i) + sensors_[s].t_vehicle_sensor;
    std::optional<Eigen::Vector3f> point_local;
    if (track != nullptr) {
      point_local =
          track->ToLocal(point_vehicle, sensor_scan.utime_start + cloud.time_offset_us[i]);
    }
    if (!point_local) {
      if (!stationary_) ++result.num_undeskewed;
      point_local = T_local_vehicle_end * point_vehicle;
    }
    merged_.Add(*point_local, cloud.intensity[i]);
  }
}

std::size_t PointCounts::*Preprocessor::Fate(const SensorGeometry& sensor,
                                             const PointCloud& cloud,
                                             std::size_t i) const {
  if (!IsMeasurement(cloud, i)) return &PointCounts::invalid;
  const Eigen::Vector3f point_sensor = cloud.Point(i);
  const float range2_m2 = point_sensor.squaredNorm();
  if (range2_m2 == 0.0F) return &PointCounts::zero;
  if (range2_m2 < sensor.min_range2_m2 || range2_m2 > sensor.max_range2_m2) {
    return &PointCounts::out_of_range;
  }
  if (IsNoise(cloud.tag[i])) return &PointCounts::noise;
  return Mask(sensor.R_vehicle_sensor * point_sensor + sensor.t_vehicle_sensor);
}

std::size_t PointCounts::*Preprocessor::Mask(const Eigen::Vector3f& point_vehicle) const {
  if (!config_.crop_box.Contains(point_vehicle)) return &PointCounts::cropped;
  if (IsInAny(body_, point_vehicle)) return &PointCounts::body;
  if (IsInAny(config_.exclusion_zones, point_vehicle)) return &PointCounts::excluded;
  return &PointCounts::kept;
}

bool Preprocessor::IsNoise(std::uint8_t tag) const {
  if (config_.drop_noise == NoiseFilter::kOff) return false;
  const int limit = config_.drop_noise == NoiseFilter::kCertain ? 1 : 2;
  const int by_intensity = (tag >> 2) & 3;
  const int by_position = tag & 3;
  return (by_intensity >= 1 && by_intensity <= limit) || (by_position >= 1 && by_position <= limit);
}

PointCloud Preprocessor::SplitFloor(const PointCloud& cloud_vehicle, PreprocessedScan& result) {
  result.floor = floor_tracker_.Update(result.utime, floor_finder_->Find(cloud_vehicle));
  const FloorSplit split =
      SplitByFloor(cloud_vehicle, result.floor.fit.plane_vehicle, config_.floor);
  result.counts.floor = split.floor.size();
  result.counts.above = split.above.size();
  result.counts.below = split.below.size();
  result.obstacles_vehicle.Reserve(split.above.size() + split.below.size());
  result.flags.assign(split.above.size(), 0);
  result.flags.resize(split.above.size() + split.below.size(), kFlagBelowFloor);
  for (const std::uint32_t i : split.above) result.obstacles_vehicle.AddFrom(cloud_vehicle, i);
  for (const std::uint32_t i : split.below) result.obstacles_vehicle.AddFrom(cloud_vehicle, i);
  PointCloud floor_vehicle;
  floor_vehicle.Reserve(split.floor.size());
  for (const std::uint32_t i : split.floor) floor_vehicle.AddFrom(cloud_vehicle, i);
  return floor_vehicle;
}

void Preprocessor::UseMap(const Surroundings& surroundings,
                          const PointCloud& floor_vehicle,
                          PreprocessedScan& result) {
  if (!config_.map_filter.enabled && !config_.local_map.enabled) return;
  const FoundPose pose = FindPose(surroundings, result.utime);
  if (config_.local_map.enabled && pose.T_map_vehicle) {
    result.local_map = local_map_builder_.Build({.obstacles_vehicle = result.obstacles_vehicle,
                                                 .floor_vehicle = floor_vehicle,
                                                 .sensor_origins_vehicle = sensor_origins_vehicle_,
                                                 .T_map_vehicle = *pose.T_map_vehicle});
  }
  if (!config_.map_filter.enabled) return;
  if (surroundings.map == nullptr) {
    result.map_state = MapState::kNoMap;
  } else if (!pose.T_map_vehicle) {
    result.map_state = pose.why_not;
  } else {
    ApplyMap(*surroundings.map, *pose.T_map_vehicle, result);
  }
}

Preprocessor::FoundPose Preprocessor::FindPose(const Surroundings& surroundings,
                                               std::int64_t utime) const {
  if (surroundings.is_pose_lost) return {std::nullopt, MapState::kPoseLost};
  const std::optional<std::int64_t> newest_utime =
      surroundings.pose == nullptr ? std::nullopt : surroundings.pose->newest_utime();
  if (!newest_utime) return {std::nullopt, MapState::kNoPose};
  if (utime - *newest_utime > config_.pose.max_extrapolation_us) {
    return {std::nullopt, MapState::kPoseOld};
  }
  return {surroundings.pose->Lookup(utime), MapState::kNoPose};
}

void Preprocessor::ApplyMap(const StaticMap& map,
                            const Eigen::Isometry3d& T_map_vehicle,
                            PreprocessedScan& result) {
  const std::vector<MapVerdict> verdicts =
      map_filter_.Judge(result.obstacles_vehicle, T_map_vehicle, map);
  PointCloud kept_vehicle;
  std::vector<std::uint8_t> kept_flags;
  kept_vehicle.Reserve(verdicts.size());
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    ++result.counts.by_map[static_cast<std::size_t>(verdicts[i])];
    if (verdicts[i] != MapVerdict::kExplained) {
      kept_vehicle.AddFrom(result.obstacles_vehicle, i);
      kept_flags.push_back(result.flags[i]);
    } else if (config_.removed_points) {
      result.removed_vehicle.AddFrom(result.obstacles_vehicle, i);
      result.removal_reasons.push_back(RemovalReason::kMap);
    }
  }
  result.obstacles_vehicle = std::move(kept_vehicle);
  result.flags = std::move(kept_flags);
  result.map_version = map.version;
  const std::size_t on_map =
      result.counts.OfMap(MapVerdict::kExplained) + result.counts.OfMap(MapVerdict::kUnexplained);
  const std::size_t outside =
      result.counts.OfMap(MapVerdict::kOffMap) + result.counts.OfMap(MapVerdict::kUnknown);
  result.map_state = outside > on_map ? MapState::kOutsideMap : MapState::kFiltered;
}

}  // namespace clearway::core

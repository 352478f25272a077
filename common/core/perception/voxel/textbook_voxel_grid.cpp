// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/perception/voxel/textbook_voxel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <pcl/filters/voxel_grid.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "common/core/perception/limits.hpp"

namespace clearway::core {
namespace {

using PclCloud = pcl::PointCloud<pcl::PointXYZI>;
using Cell = Eigen::Vector3i;

// Smallest box of cells that holds a part of the cloud, both corners included.
struct CellBox {
  Cell min = Cell::Constant(std::numeric_limits<int>::max());
  Cell max = Cell::Constant(std::numeric_limits<int>::min());

  Cell Size() const { return max - min + Cell::Ones(); }
};

// PCL derives the extents that it checks from rounded products, so they may be 2 cells larger.
bool FitsPclIndex(const CellBox& box) {
  const Eigen::Vector3d size = box.Size().cast<double>() + Eigen::Vector3d::Constant(2.0);
  return size.prod() <= static_cast<double>(std::numeric_limits<std::int32_t>::max());
}

class TextbookVoxelGrid final : public VoxelGrid {
 public:
  explicit TextbookVoxelGrid(const VoxelGridConfig& config)
      : min_points_(static_cast<std::size_t>(config.min_points)),
        inverse_leaf_(1.0F / static_cast<float>(config.leaf_m)) {
    const auto leaf_m = static_cast<float>(config.leaf_m);
    filter_.setLeafSize(leaf_m, leaf_m, leaf_m);
    filter_.setMinimumPointsNumberPerVoxel(static_cast<unsigned int>(config.min_points));
  }

  Result Downsample(const PointCloud& cloud) override;

 private:
  void Load(const PointCloud& cloud);
  Cell CellOf(int i) const;
  CellBox BoxOf(std::span<const int> part) const;
  void FilterSplit(std::span<int> part, Result& result);
  void FilterPart(std::span<const int> part, const CellBox& box, Result& result);
  std::size_t CountSparse(std::span<const int> part, const CellBox& box);

  std::size_t min_points_;
  float inverse_leaf_;
  pcl::VoxelGrid<pcl::PointXYZI> filter_;
  PclCloud::Ptr input_ = std::make_shared<PclCloud>();
  PclCloud output_;
  std::vector<int> order_;  // Indices into input_; the points of a part lie side by side.
  std::vector<std::uint32_t> keys_;
};

VoxelGrid::Result TextbookVoxelGrid::Downsample(const PointCloud& cloud) {
  Load(cloud);
  Result result;
  result.num_invalid = cloud.size() - input_->size();
  result.cloud.Reserve(input_->size());
  order_.resize(input_->size());
  for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<int>(i);
  if (!order_.empty()) FilterSplit(order_, result);
  return result;
}

void TextbookVoxelGrid::Load(const PointCloud& cloud) {
  input_->clear();
  input_->reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!IsMeasurement(cloud, i)) continue;
    pcl::PointXYZI point;
    point.x = cloud.x[i];
    point.y = cloud.y[i];
    point.z = cloud.z[i];
    point.intensity = static_cast<float>(cloud.intensity[i]);
    input_->push_back(point);
  }
  filter_.setInputCloud(input_);
}

// With the operations of pcl::VoxelGrid, so that no cell of its is ever cut.
Cell TextbookVoxelGrid::CellOf(int i) const {
  const pcl::PointXYZI& p = (*input_)[static_cast<std::size_t>(i)];
  return {static_cast<int>(std::floor(p.x * inverse_leaf_)),
          static_cast<int>(std::floor(p.y * inverse_leaf_)),
          static_cast<int>(std::floor(p.z * inverse_leaf_))};
}

CellBox TextbookVoxelGrid::BoxOf(std::span<const int> part) const {
  CellBox box;
  for (const int i : part) {
    const Cell cell = CellOf(i);
    box.min = box.min.cwiseMin(cell);
    box.max = box.max.cwiseMax(cell);
  }
  return box;
}

// Halves the longest side until the part fits. Each half is shrunk to its points first, so the
// depth is bounded by the bits of the three cell indices.
void TextbookVoxelGrid::FilterSplit(std::span<int> part, Result& result) {
  const CellBox box = BoxOf(part);
  if (FitsPclIndex(box)) {
    FilterPart(part, box, result);
    return;
  }
  Eigen::Index axis = 0;
  box.Size().maxCoeff(&axis);
  const int first_of_upper = box.min[axis] + box.Size()[axis] / 2;
  const auto upper = std::stable_partition(
      part.begin(), part.end(), [&](int i) { return CellOf(i)[axis] < first_of_upper; });
  const auto num_lower = static_cast<std::size_t>(upper - part.begin());
  FilterSplit(part.first(num_lower), result);
  FilterSplit(part.subspan(num_lower), result);
}

void TextbookVoxelGrid::FilterPart(std::span<const int> part, const CellBox& box, Result& result) {
  const bool is_whole = part.size() == input_->size();
  filter_.setIndices(is_whole ? pcl::IndicesPtr()
                              : std::make_shared<pcl::Indices>(part.begin(), part.end()));
  filter_.filter(output_);
  for (const pcl::PointXYZI& mean : output_) {
    result.cloud.Add(mean.getVector3fMap(),
                     static_cast<std::uint8_t>(std::clamp(std::lround(mean.intensity), 0L, 255L)));
  }
  if (min_points_ > 1) result.num_sparse += CountSparse(part, box);
}

// PCL does not tell how many points it left out.
std::size_t TextbookVoxelGrid::CountSparse(std::span<const int> part, const CellBox& box) {
  const Eigen::Matrix<std::uint32_t, 3, 1> size = box.Size().cast<std::uint32_t>();
  keys_.clear();
  for (const int i : part) {
    const Eigen::Matrix<std::uint32_t, 3, 1> cell = (CellOf(i) - box.min).cast<std::uint32_t>();
    keys_.push_back((cell.z() * size.y() + cell.y()) * size.x() + cell.x());
  }
  std::sort(keys_.begin(), keys_.end());
  std::size_t num_sparse = 0;
  for (auto first = keys_.begin(); first != keys_.end();) {
    const auto last = std::upper_bound(first, keys_.end(), *first);
    const auto count = static_cast<std::size_t>(last - first);
    if (count < min_points_) num_sparse += count;
    first = last;
  }
  return num_sparse;
}

}  // namespace

std::unique_ptr<VoxelGrid> MakeTextbookVoxelGrid(const VoxelGridConfig& config) {
  return std::make_unique<TextbookVoxelGrid>(config);
}

}  // namespace clearway::core

// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/score.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "tools/evaluate/membership.hpp"

namespace clearway::evaluate {
namespace {

// How many points of one detection lie in a box, and how many it has.
struct Share {
  std::size_t inside = 0;
  std::size_t all = 0;

  [[nodiscard]] bool IsAtLeast(double share) const {
    return inside > 0 && static_cast<double>(inside) >= share * static_cast<double>(all);
  }
};

using Members = std::vector<std::vector<std::size_t>>;

// For each detection its share in the box.
std::vector<Share> SharesIn(const Box& box,
                            const Scene& scene,
                            const Members& members,
                            double tolerance_m) {
  std::vector<Share> shares;
  for (const std::vector<std::size_t>& points : members) {
    const auto inside = std::count_if(points.begin(), points.end(), [&](std::size_t i) {
      return Contains(box, scene.points.Point(i).cast<double>(), tolerance_m);
    });
    shares.push_back({static_cast<std::size_t>(inside), points.size()});
  }
  return shares;
}

bool HasHeading(const std::string& kind) {
  std::string lower = kind;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return lower == "car" || lower == "van" || lower == "truck";
}

double CentreError(const core::Detection& detection, const Box& box) {
  const Eigen::Vector3d offset = detection.centroid.cast<double>() - box.T_F_box.translation();
  return offset.head<2>().norm();
}

ObjectScore CompareWithMatch(const core::Detection& match, const Box& box) {
  ObjectScore score;
  score.any_evidence = true;
  score.centre_error_m = CentreError(match, box);
  score.nearest_error_m =
      std::abs(static_cast<double>(match.nearest.norm()) - NearestDistance(box));
  if (HasHeading(box.kind)) {
    score.yaw_error_rad =
        QuarterTurnDifference(static_cast<double>(match.rectangle.yaw_rad), Yaw(box));
  }
  return score;
}

double Range(const Box& box) {
  return box.T_F_box.translation().head<2>().norm();
}

ObjectScore ScoreBox(const Box& box,
                     const std::vector<core::Detection>& detections,
                     const std::vector<Share>& shares,
                     double radius_m) {
  const auto most = std::max_element(
      shares.begin(), shares.end(), [](Share a, Share b) { return a.inside < b.inside; });
  ObjectScore score;
  if (most != shares.end() && most->inside > 0) {
    score = CompareWithMatch(detections[static_cast<std::size_t>(most - shares.begin())], box);
    score.separated = most->IsAtLeast(kSeparatedShare);
    for (auto share = shares.begin(); share != shares.end(); ++share) {
      if (share != most && share->IsAtLeast(kSeparatedShare)) ++score.splits;
    }
  }
  score.range_m = Range(box);
  score.within_radius = std::any_of(detections.begin(), detections.end(), [&](const auto& d) {
    return CentreError(d, box) <= radius_m;
  });
  return score;
}

std::size_t CountMerges(const std::vector<std::vector<Share>>& shares_by_box,
                        std::size_t num_detections) {
  std::size_t merges = 0;
  for (std::size_t k = 0; k < num_detections; ++k) {
    const auto boxes =
        std::count_if(shares_by_box.begin(), shares_by_box.end(), [k](const auto& shares) {
          return shares[k].IsAtLeast(kMergedShare);
        });
    if (boxes >= 2) ++merges;
  }
  return merges;
}

}  // namespace

SceneScore ScoreScene(const Scene& scene, const ScoreRules& rules) {
  SceneScore score;
  score.detections = scene.detections.size();
  const Members members = PointsOfDetections(scene.points, scene.detections);
  std::vector<std::vector<Share>> shares_by_box;
  for (const Box& box : scene.boxes) {
    if (box.points < rules.min_points) {
      ++score.few_points;
    } else if (!(Range(box) < kMaxRange_m)) {
      ++score.out_of_range;
    } else {
      shares_by_box.push_back(SharesIn(box, scene, members, rules.tolerance_m));
      score.objects.push_back(
          ScoreBox(box, scene.detections, shares_by_box.back(), rules.radius_m));
    }
  }
  score.merges = CountMerges(shares_by_box, scene.detections.size());
  return score;
}

}  // namespace clearway::evaluate

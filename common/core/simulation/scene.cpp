// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/scene.hpp"

#include <set>

#include "common/core/simulation/scene_geometry.hpp"

namespace clearway::core {

std::vector<std::string> SceneShelf::Validate() const {
  std::vector<std::string> problems = object.Validate("shelf");
  const std::string who = "shelf \"" + object.name + "\": ";
  if (lowest_board_m + num_boards * board_thickness_m > height_m) {
    problems.push_back(who +
                       "its boards, one on the other from lowest_board_m on, do not fit "
                       "into height_m.");
  }
  if (2.0 * post_width_m > length_m || 2.0 * post_width_m > width_m) {
    problems.push_back(who + "two posts do not fit into its length_m and width_m.");
  }
  return problems;
}

std::vector<std::string> SceneTable::Validate() const {
  std::vector<std::string> problems = object.Validate("table");
  const std::string who = "table \"" + object.name + "\": ";
  if (top_thickness_m >= height_m) {
    problems.push_back(who + "top_thickness_m must be less than height_m.");
  }
  const double needed_m = 2.0 * (overhang_m + leg_diameter_m);
  if (needed_m > length_m || needed_m > width_m) {
    problems.push_back(who + "two legs and two overhangs do not fit under its top.");
  }
  return problems;
}

std::vector<std::string> SceneHole::Validate() const {
  std::vector<std::string> problems = object.Validate("hole");
  if (object.z_m != 0.0) {
    problems.push_back("hole \"" + object.name + "\": z_m must be 0: holes are in the floor.");
  }
  return problems;
}

std::vector<std::string> SceneWall::Validate() const {
  if (x1_m != x2_m || y1_m != y2_m) return {};
  return {"wall \"" + name + "\": its ends must be two different points."};
}

std::vector<std::string> SceneRoom::Validate() const {
  if (x_min_m < x_max_m && y_min_m < y_max_m) return {};
  return {"room \"" + name + "\": x_min_m must be less than x_max_m, and y_min_m than y_max_m."};
}

std::vector<std::string> SceneConfig::Validate() const {
  std::vector<std::string> problems;
  std::set<std::string> seen;
  std::set<std::string> reported;
  for (const ObjectInfo& info : DescribeObjects(*this)) {
    const std::string kind = KindName(info.kind);
    if (info.name.empty()) {
      problems.push_back("Every " + kind + " of the scene needs a name.");
    } else if (!seen.insert(info.name).second && reported.insert(info.name).second) {
      problems.push_back("The name \"" + info.name + "\" stands for more than one object.");
    }
  }
  return problems;
}

}  // namespace clearway::core

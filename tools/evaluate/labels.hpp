// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/evaluate/box.hpp"

namespace clearway::evaluate {

/// Labelled boxes in the sensor's frame, by the stem of the scan's file.
using Labels = std::map<std::string, std::vector<Box>>;

/// Reads labels: a file with one JSON object {"stem": [box, ...], ...}, or a folder with a list
/// [box, ...] in <stem>.json for each scan. A box is an object with the numbers x y z (centre), l
/// (along yaw) w h [m], yaw (about z) [rad], n (points inside) and the text cls; what else it holds
/// is passed over. A scan with an empty list has nothing in it; one that is not there is not
/// labelled.
/// Throws io::ReadError that names the file, the key, the box (from 0), the field, and what is
/// allowed: the file is not JSON; another structure; a key twice; a field is missing, of another
/// type or out of bounds; no labels at all.
[[nodiscard]] Labels ReadLabels(const std::filesystem::path& path);

}  // namespace clearway::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/world.hpp"

namespace clearway::core {

World::World(const SceneConfig& scene, std::optional<MapWalls> /*walls*/)
    : scene_(scene), geometry_(GeometryAt(scene, 0)) {}

}  // namespace clearway::core

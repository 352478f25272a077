// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/perception/floor/floor_finder.hpp"

#include <stdexcept>

#include "common/core/perception/floor/textbook_floor_finder.hpp"

namespace clearway::core {

std::unique_ptr<FloorFinder> MakeFloorFinder(Backend backend, const FloorConfig& config) {
  switch (backend) {
    case Backend::kTextbook:
      return MakeTextbookFloorFinder(config);
  }
  throw std::invalid_argument("MakeFloorFinder: unknown backend");
}

}  // namespace clearway::core

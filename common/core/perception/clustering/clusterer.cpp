// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/perception/clustering/clusterer.hpp"

#include <stdexcept>

#include "common/core/perception/clustering/textbook_clusterer.hpp"

namespace clearway::core {

std::unique_ptr<Clusterer> MakeClusterer(Backend backend, const ClusteringConfig& config) {
  switch (backend) {
    case Backend::kTextbook:
      return MakeTextbookClusterer(config);
  }
  throw std::invalid_argument("MakeClusterer: unknown backend");
}

}  // namespace clearway::core

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/core/mapping/map_filter.hpp"
#include "common/core/mapping/map_tiles.hpp"
#include "common/core/scan/sequence_tracker.hpp"
#include "common/process/node.hpp"

namespace clearway::process {

/// The receiving end of the map server: fetches the static layer, whole, asks again for the tiles
/// that did not come, fetches it anew when the server's status tells another version, and gives it
/// up when the server falls silent.
class MapClient {
 public:
  /// Without a status of the server for this long its map is not used any more [us].
  static constexpr std::int64_t kServerSilentUs = 2'500'000;

  /// `client` is the asking process's name.
  MapClient(Node& node, std::string client);
  MapClient(const MapClient&) = delete;
  MapClient& operator=(const MapClient&) = delete;

  /// The map, whole and of the version that its living server tells; null otherwise.
  [[nodiscard]] const core::StaticMap* map() const;

  /// Why there is none, in words; empty when there is one.
  [[nodiscard]] std::string Trouble() const;

  /// Sets the counters map_epoch (0: no map), map_tiles, map_tiles_missing and map_tiles_refused of
  /// the node's status.
  void SetCounters();

 private:
  void OnServerStatus(const status_t& status);
  void OnTile(const map_tile_t& message);
  void Finish();
  void AskForWhatIsMissing();
  [[nodiscard]] bool IsServerSilent() const;
  [[nodiscard]] bool HasTwoServers() const;

  Node& node_;
  std::string client_;
  core::SequenceTracker servers_;
  std::optional<core::MapVersion> announced_;
  std::int64_t status_us_ = 0;
  std::optional<std::int64_t> second_server_us_;
  core::MapAssembler assembler_;
  std::unique_ptr<const core::StaticMap> map_;
  std::int64_t last_tile_us_ = 0;
  std::int64_t refused_ = 0;
};

}  // namespace clearway::process

// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/map_client.hpp"

#include <algorithm>
#include <utility>

#include "common/messages/map_tiles.hpp"

namespace clearway::process {
namespace {

namespace channels = messages::channels;

// How often it is looked after what is missing, and how long tiles must have stayed away [us].
constexpr std::int64_t kAskPeriodUs = 250'000;
constexpr std::int64_t kQuietUs = 200'000;
// Two statuses of different servers within this time are two servers [us].
constexpr std::int64_t kTwoServersUs = 3'000'000;
// Tiles named in one request, so that it stays small; the others are asked for next time.
constexpr std::size_t kMaxNamedTiles = 200;

std::int64_t CounterOf(const status_t& status, const std::string& name) {
  const auto found = std::find_if(
      status.counters.begin(), status.counters.end(), [&name](const counter_t& counter) {
        return counter.name == name;
      });
  return found == status.counters.end() ? 0 : found->value;
}

}  // namespace

MapClient::MapClient(Node& node, std::string client) : node_(node), client_(std::move(client)) {
  node_.Subscribe<status_t>(channels::kMapServerStatus,
                            [this](const auto& status) { OnServerStatus(status); });
  node_.Subscribe<map_tile_t>(channels::kMap, [this](const auto& tile) { OnTile(tile); });
  node_.runtime().Every(kAskPeriodUs, [this] { AskForWhatIsMissing(); });
}

void MapClient::OnServerStatus(const status_t& status) {
  const std::int64_t now_us = node_.runtime().MonotonicUs();
  const core::SequenceVerdict verdict = servers_.Observe(status.session, status.sequence, now_us);
  if (verdict == core::SequenceVerdict::kForeign) second_server_us_ = now_us;
  if (!core::IsNewest(verdict)) return;
  status_us_ = now_us;
  const core::MapVersion version{status.session, CounterOf(status, "map_epoch")};
  if (version.epoch <= 0) {
    announced_.reset();
    return;
  }
  if (announced_ == version) return;
  announced_ = version;
  // What the assembler knows of versions that gave way is of no use: the server's word counts.
  assembler_ = core::MapAssembler();
  last_tile_us_ = now_us - kQuietUs;
  AskForWhatIsMissing();
}

void MapClient::OnTile(const map_tile_t& message) {
  if (message.layer != map_request_t::LAYER_STATIC) return;
  // Before the cells are decoded: a tile for somebody else costs next to nothing.
  const core::MapVersion version{message.session, message.epoch};
  if (map_ && map_->version == version) return;  // Somebody else asked for it.
  if (version != announced_) {
    ++refused_;
    return;
  }
  const auto tile = messages::FromLcm(message);
  if (!tile) {
    node_.CountInvalid();
    return;
  }
  using Outcome = core::MapAssembler::Outcome;
  const Outcome outcome = assembler_.Add(*tile);
  if (outcome == Outcome::kInvalid) node_.CountInvalid();
  if (outcome == Outcome::kOldVersion) ++refused_;
  if (outcome == Outcome::kInconsistent) {
    // Either this one is wrong or what came before it: only a new start gets out of that.
    ++refused_;
    assembler_.Clear();
  }
  last_tile_us_ = node_.runtime().MonotonicUs();
  Finish();
}

void MapClient::Finish() {
  if (assembler_.IsCorrupt()) {
    ++refused_;
    assembler_.Clear();
  } else if (assembler_.IsComplete()) {
    map_ = std::make_unique<const core::StaticMap>(*assembler_.version(), assembler_.grid());
    assembler_.Clear();
  }
}

void MapClient::AskForWhatIsMissing() {
  const std::int64_t now_us = node_.runtime().MonotonicUs();
  const bool is_wanted = announced_ && !IsServerSilent() && (!map_ || map_->version != *announced_);
  if (!is_wanted || now_us - last_tile_us_ < kQuietUs) return;
  map_request_t request{};
  request.utime = node_.runtime().UtimeNow();
  request.client = client_;
  request.layer = map_request_t::LAYER_STATIC;
  if (assembler_.version() == announced_) {
    request.epoch = announced_->epoch;
    for (const int tile : assembler_.Missing(kMaxNamedTiles)) request.missing.push_back(tile);
    request.n_missing = static_cast<std::int32_t>(request.missing.size());
  }
  node_.Publish(channels::kMapRequest, std::move(request));
}

bool MapClient::IsServerSilent() const {
  return !announced_ || node_.runtime().MonotonicUs() - status_us_ > kServerSilentUs;
}

bool MapClient::HasTwoServers() const {
  return second_server_us_ && node_.runtime().MonotonicUs() - *second_server_us_ <= kTwoServersUs;
}

const core::StaticMap* MapClient::map() const {
  const bool is_usable =
      map_ && !IsServerSilent() && !HasTwoServers() && map_->version == announced_;
  return is_usable ? map_.get() : nullptr;
}

std::string MapClient::Trouble() const {
  if (map() != nullptr) return {};
  if (HasTwoServers()) return "two map servers are running";
  if (servers_.counts().received == 0) return "no map server has been heard";
  if (!announced_) return "the map server has no map";
  if (IsServerSilent()) return "the map server fell silent";
  return "the map is on its way: " + std::to_string(assembler_.received()) + " of " +
         std::to_string(assembler_.count()) + " tiles";
}

void MapClient::SetCounters() {
  const core::StaticMap* const usable = map();
  node_.SetCounter("map_epoch", usable == nullptr ? 0 : usable->version.epoch);
  node_.SetCounter("map_tiles", assembler_.received());
  node_.SetCounter("map_tiles_missing", assembler_.count() - assembler_.received());
  node_.SetCounter("map_tiles_refused", refused_);
}

}  // namespace clearway::process

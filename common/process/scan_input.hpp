// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "common/core/scan/freshness_watch.hpp"
#include "common/core/scan/scan_assembler.hpp"
#include "common/process/node.hpp"

namespace clearway::process {

/// A ScanAssembler at the end of a node's input: calls back for each scan that is whole or due,
/// keeps the timer for what is due, and tells the counts in the node's status.
class ScanInput {
 public:
  ScanInput(Node& node,
            const core::ScanAssemblerConfig& config,
            int num_sensors,
            std::function<void(const core::AssembledScan&)> on_scan);

  /// Takes a slice. Its scan is handed on by the next Emit().
  core::SliceOutcome Add(core::Slice slice);

  /// Hands on the scans that are whole or due.
  void Emit();

  /// What is wrong with the input as a whole, as a state; nothing while scans come in time.
  [[nodiscard]] std::optional<State> Trouble(const std::string& channel) const;

  /// Sets scans, scans_incomplete, slices_* and sender_restarts of the node's status.
  void SetCounters();

 private:
  [[nodiscard]] std::int64_t Refused() const;

  Node& node_;
  core::ScanAssembler assembler_;
  std::function<void(const core::AssembledScan&)> on_scan_;
  std::optional<Runtime::TimerId> deadline_;
  core::FreshnessWatch freshness_;
  std::int64_t scans_ = 0;
  std::int64_t incomplete_scans_ = 0;
};

}  // namespace clearway::process

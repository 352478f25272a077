// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/scan_input.hpp"

#include <utility>

namespace clearway::process {

ScanInput::ScanInput(Node& node,
                     const core::ScanAssemblerConfig& config,
                     int num_sensors,
                     std::function<void(const core::AssembledScan&)> on_scan)
    : node_(node), assembler_(config, num_sensors), on_scan_(std::move(on_scan)) {}

core::SliceOutcome ScanInput::Add(core::Slice slice) {
  const core::SliceOutcome outcome =
      assembler_.Add(std::move(slice), node_.runtime().MonotonicUs());
  if (outcome == core::SliceOutcome::kInvalid) node_.CountInvalid();
  return outcome;
}

void ScanInput::Emit() {
  for (const core::AssembledScan& scan : assembler_.Poll(node_.runtime().MonotonicUs())) {
    ++scans_;
    if (!scan.complete) ++incomplete_scans_;
    on_scan_(scan);
  }
  if (deadline_) node_.runtime().Cancel(*deadline_);
  deadline_.reset();
  if (const auto due_us = assembler_.NextDeadline()) {
    deadline_ = node_.runtime().After(*due_us - node_.runtime().MonotonicUs(), [this] { Emit(); });
  }
}

void ScanInput::SetCounters() {
  using core::SliceOutcome;
  node_.SetCounter("scans", scans_);
  node_.SetCounter("scans_incomplete", incomplete_scans_);
  node_.SetCounter("slices_duplicate", assembler_.count(SliceOutcome::kDuplicate));
  node_.SetCounter("slices_foreign", assembler_.count(SliceOutcome::kForeign));
  node_.SetCounter("slices_inconsistent", assembler_.count(SliceOutcome::kInconsistent));
  node_.SetCounter("slices_late", assembler_.count(SliceOutcome::kLate));
  node_.SetCounter("slices_unknown_sensor", assembler_.count(SliceOutcome::kUnknownSensor));
  node_.SetCounter("sender_restarts", assembler_.restarts());
}

}  // namespace clearway::process

// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/scan_input.hpp"

#include <utility>

namespace clearway::process {
namespace {

// Without a scan for this long the input is missing; a scan that is later than this is old [us].
constexpr std::int64_t kMissingUs = 500'000;

}  // namespace

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
    freshness_.OnArrival(node_.runtime().MonotonicUs(), scan.utime_end);
    if (!scan.complete) ++incomplete_scans_;
    on_scan_(scan);
  }
  if (deadline_) node_.runtime().Cancel(*deadline_);
  deadline_.reset();
  if (const auto due_us = assembler_.NextDeadline()) {
    deadline_ = node_.runtime().After(*due_us - node_.runtime().MonotonicUs(), [this] { Emit(); });
  }
}

std::optional<State> ScanInput::Trouble(const std::string& channel) const {
  const auto scans = freshness_.Query(node_.runtime().MonotonicUs());
  const std::int64_t input_age_us = node_.InputAgeUs();
  const bool scans_come = scans.has_arrived && scans.age_us <= kMissingUs;
  if (scans_come && scans.lateness_us <= kMissingUs) return std::nullopt;
  if (scans_come) {
    return State{
        status_t::STATE_DEGRADED,
        true,
        "cannot keep up: scans are late by " + std::to_string(scans.lateness_us / 1000) + " ms"};
  }
  if (input_age_us >= 0 && input_age_us <= kMissingUs && Refused() > 0) {
    return State{status_t::STATE_FAULT,
                 true,
                 channel + " arrives, but nothing of it can be used: see the counts slices_*"};
  }
  if (!scans.has_arrived) return State{status_t::STATE_WAITING, true, "no " + channel + " yet"};
  return State{
      status_t::STATE_WAITING, true, channel + " stopped: is the process that sends it running?"};
}

std::int64_t ScanInput::Refused() const {
  std::int64_t refused = 0;
  for (std::size_t i = 0; i < core::kNumSliceOutcomes; ++i) {
    const auto outcome = static_cast<core::SliceOutcome>(i);
    if (outcome != core::SliceOutcome::kAccepted) refused += assembler_.count(outcome);
  }
  return refused;
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

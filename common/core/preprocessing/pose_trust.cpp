// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/preprocessing/pose_trust.hpp"

namespace clearway::core {

void PoseTrust::OnPose(std::int64_t utime, PoseBuffer::Outcome outcome, std::int64_t now_us) {
  using Outcome = PoseBuffer::Outcome;
  if (outcome == Outcome::kInvalid) return;
  if (heard_us_ && now_us - *heard_us_ > kSourceDied_us) is_lost_ = false;
  heard_us_ = now_us;
  if (outcome == Outcome::kOutOfOrder) NoteTwoSources(now_us);
  if (outcome == Outcome::kRestarted) step_back_ = StepBack{newest_utime_.value_or(utime), now_us};
  if (outcome == Outcome::kAdded && step_back_ && utime >= step_back_->from_utime) {
    if (now_us - step_back_->at_us <= kTwoSources_us) NoteTwoSources(now_us);
    step_back_.reset();
  }
  if (outcome == Outcome::kAdded || outcome == Outcome::kRestarted) newest_utime_ = utime;
}

void PoseTrust::OnStatus(bool is_lost,
                         std::int64_t session,
                         std::int64_t sequence,
                         std::int64_t now_us) {
  const SequenceVerdict verdict = statuses_.Observe(session, sequence, now_us);
  if (verdict == SequenceVerdict::kOutOfOrder) return;
  heard_us_ = now_us;
  const bool is_believed =
      verdict != SequenceVerdict::kForeign && verdict != SequenceVerdict::kInvalid;
  if (is_lost || is_believed) is_lost_ = is_lost;
}

PoseTrust::Doubt PoseTrust::Query(std::int64_t now_us) const {
  if (two_sources_us_ && now_us - *two_sources_us_ <= kTwoSources_us) return Doubt::kTwoSources;
  return is_lost_ ? Doubt::kLost : Doubt::kNone;
}

void PoseTrust::NoteTwoSources(std::int64_t now_us) {
  ++out_of_order_;
  two_sources_us_ = now_us;
}

}  // namespace clearway::core

// SPDX-License-Identifier: Apache-2.0
// The background's side of a change of shaper.
#include "shaper/axis/axis_core.hpp"

namespace stillpoint {

namespace {

constexpr uint32_t kMostLeadTicks = UINT32_C(1) << 12;

// A search runs both lines full before it looks, at some ten ticks of the move a tick of the clock or more.
uint32_t first_lead(const Shaper& a, const Shaper& b) { return 16 + (a.length_ticks() + b.length_ticks()) / 16; }

}  // namespace

Status AxisCore::set_shaper(const ShaperDesign& design, Retune when) {
  const uint32_t epoch = load(epoch_);
  const AxisState now = state();
  const bool moving = when == Retune::kBlended && configured_ && !pending() && now.phase != AxisPhase::kAtRest;
  Status status = moving ? kOk : check_ready();
  if (!status.ok()) return status;
  const uint32_t spare = active_shaper_ ^ 1;
  status = shapers_[spare].configure(design, memory_[spare], capacity_, now.setpoint);
  if (!status.ok()) return status;
  if (moving) {
    blend_lead_ = first_lead(running(), shapers_[spare]);
    offer_blend(epoch, now);
  } else {
    hand_over(kShaper, epoch);
  }
  return kOk;
}

void AxisCore::service() {
  if (load(pending_) != kLaterShaper || !look_again_) return;
  // From here on no tick takes it; one that did has done so before.
  store(looking_, 1);
  __atomic_signal_fence(__ATOMIC_SEQ_CST);
  const uint32_t epoch = load(epoch_);
  const AxisState now = state();
  if (load(pending_) == kLaterShaper && static_cast<int32_t>(now.tick - look_again_at_) >= 0) offer_blend(epoch, now);
  store(looking_, 0);
}

// The spare shaper, its line and the mailbox are the background's here.
void AxisCore::offer_blend(uint32_t epoch, const AxisState& now) {
  look_again_ = false;
  const bool in_move = now.phase == AxisPhase::kMoving || now.phase == AxisPhase::kDraining;
  hand_over(in_move && find_blend(now) ? kBlend : kLaterShaper, epoch);
}

bool AxisCore::find_blend(const AxisState& now) {
  Shaper& next = shapers_[active_shaper_ ^ 1];
  const size_t used = next.memory_used();
  Shaper old;
  if (!old.configure(running(), memory_[active_shaper_ ^ 1] + used, capacity_ - used, now.setpoint).ok()) return false;
  const Track& track = tracks_[active_track_];
  const uint32_t stages = old.stage_count() > next.stage_count() ? old.stage_count() : next.stage_count();
  const BlendLimits limits = BlendLimits::make(move_.limits, move_.jerk_limited(), config_.tick_s, stages,
                                               track.target() >= signal_of(track.start));
  const uint32_t began = load(move_began_);
  const uint32_t ahead = blend_lead_ + next.length_ticks() + 1;
  BlendWindow window{};
  uint32_t resume = 0;
  BlendSearch search(track, limits, old, next);
  // A mean of the input's past is within whatever limits that keeps.
  const bool proved = next.averages() && !move_sped_up_;
  const bool found = search.find(now.tick - began + ahead, proved, window, resume);
  if (found) {
    // Looked at again, the tick has missed it: another time more of the clock is left for the search.
    blend_begin_ = began + window.begin;
    blend_order_ = window.order;
    look_again_at_ = now.tick;
    if (blend_lead_ < kMostLeadTicks) blend_lead_ *= 2;
  } else {
    look_again_at_ = began + resume - ahead;
  }
  look_again_ = found || resume != UINT32_MAX;
  return found;
}

}  // namespace stillpoint

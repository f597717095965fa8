// SPDX-License-Identifier: Apache-2.0
// The background's side of a change of shaper.
#include "shaper/axis/axis_core.hpp"

namespace stillpoint {

namespace {

constexpr uint32_t kMostLeadTicks = UINT32_C(1) << 12;
// Longer than any ramp to it.
constexpr uint32_t kLongestCruiseTicks = kMaxDurationTicks;

// A search runs both lines full before it looks, at some ten ticks of the move a tick of the clock or more.
uint32_t first_lead(const Shaper& a, const Shaper& b) { return 16 + (a.length_ticks() + b.length_ticks()) / 16; }

}  // namespace

template <typename Source>
Status AxisCore::configure_spare(const Source& source, Signal position) {
  if (lent_) return refuse(Error::kBusy);
  const uint32_t spare = active_shaper_ ^ 1;
  return shapers_[spare].configure(source, memory_[spare], capacity_, position);
}

Status AxisCore::set_shaper(const ShaperDesign& design, Retune when) {
  const uint32_t epoch = load(epoch_);
  const AxisState now = state();
  const bool moving = when == Retune::kBlended && configured_ && !pending() && now.phase != AxisPhase::kAtRest;
  Status status = moving ? kOk : check_ready();
  if (!status.ok()) return status;
  status = configure_spare(design, now.setpoint);
  if (!status.ok()) return status;
  if (moving) {
    blend_lead_ = first_lead(running(), shapers_[active_shaper_ ^ 1]);
    offer_blend(epoch, now);
  } else {
    hand_over(kShaper, epoch);
  }
  return status;
}

Status AxisCore::fill_spare(Signal start) { return configure_spare(running(), start); }

double* AxisCore::lend_memory(size_t& doubles) {
  if (!configured_ || load(pending_) != kNothing) return nullptr;
  static_assert(sizeof(LineSample) == sizeof(double) && alignof(LineSample) >= alignof(double), "one for the other");
  lent_ = true;
  doubles = capacity_;
  return reinterpret_cast<double*>(memory_[active_shaper_ ^ 1]);
}

void AxisCore::service() {
  if (load(pending_move_) == kMissed) {
    store(pending_move_, kNoMove);
    if (flight_lead_ < kMostLeadTicks) flight_lead_ *= 2;
    if (!fly(flight_, nullptr).ok()) flight_lead_ = 0;
  }
  if (load(pending_) != kLaterShaper || load(pending_move_) != kNoMove || !look_again_) return;
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
  const Terms& terms = terms_[active_track_];
  AxisLimits of_move = terms.move.limits;
  if (terms.may_turn) {
    if (of_move.acceleration > of_move.deceleration) of_move.acceleration = of_move.deceleration;
    of_move.deceleration = of_move.acceleration;
  }
  const bool forward = wrapping_difference(track.target(), signal_of(track.start)) >= 0;
  const BlendLimits limits = BlendLimits::make(of_move, terms.move.jerk_limited(), config_.tick_s, stages, forward);
  // A cruise is the same wherever one looks; so a year of it is not counted.
  const uint32_t elapsed =
      now.track_ticks < kLongestCruiseTicks ? static_cast<uint32_t>(now.track_ticks) : kLongestCruiseTicks;
  const uint32_t began = now.tick - elapsed;
  const uint32_t ahead = blend_lead_ + next.length_ticks() + 1;
  BlendWindow window{};
  uint32_t resume = 0;
  BlendSearch search(track, limits, old, next);
  // A mean of the input's past is within whatever limits that keeps.
  const bool proved = next.averages() && !terms.only_checked;
  const bool found = search.find(elapsed + ahead, proved, window, resume);
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

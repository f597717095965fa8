// SPDX-License-Identifier: Apache-2.0
#include "firmware/feedback_watch.hpp"

#include "shaper/base/shared.hpp"

namespace stillpoint::firmware {
namespace {

bool exceeds(Signal difference, uint32_t counts) {
  const uint64_t magnitude =
      difference < 0 ? uint64_t{0} - static_cast<uint64_t>(difference) : static_cast<uint64_t>(difference);
  return magnitude > uint64_t{counts} << kSignalFractionBits;
}

// One tick more outside, or none; true once it has been too many.
bool lasts(bool outside, uint32_t allowed, uint32_t& ticks) {
  if (!outside) {
    ticks = 0;
    return false;
  }
  return ++ticks > allowed;
}

}  // namespace

void FeedbackWatch::set(const FeedbackLimits& limits) {
  store(following_window_, limits.following_window);
  store(ticks_, limits.ticks);
  store(most_per_tick_, limits.most_per_tick);
  store(margin_, limits.margin);
  store(low_, static_cast<uint32_t>(limits.low));
  store(high_, static_cast<uint32_t>(limits.high));
}

FaultCode FeedbackWatch::look(Signal setpoint, Signal position, Signal change, bool neighbours) {
  const uint32_t most = load(most_per_tick_);
  if (neighbours && most != 0 && exceeds(change, most)) return FaultCode::kEncoderImplausible;
  const uint32_t allowed = load(ticks_);
  const uint32_t window = load(following_window_);
  const bool lags = window != 0 && exceeds(wrapping_difference(setpoint, position), window);
  if (lasts(lags, allowed, lagging_)) return FaultCode::kFollowingError;
  return lasts(is_beyond(position), allowed, beyond_) ? FaultCode::kPositionLimit : FaultCode::kNone;
}

[[gnu::noinline]] uint32_t FeedbackWatch::beyond_limit(Signal position) const {
  const auto low = static_cast<int32_t>(load(low_));
  const auto high = static_cast<int32_t>(load(high_));
  const auto counts = static_cast<int32_t>(position >> kSignalFractionBits);
  if (low >= high || (counts >= low && counts <= high)) return 0;
  const auto edge = static_cast<uint32_t>(counts < low ? low : high);
  const uint32_t distance = counts < low ? edge - static_cast<uint32_t>(counts) : static_cast<uint32_t>(counts) - edge;
  const uint32_t margin = load(margin_);
  return distance > margin ? distance - margin : 0;
}

bool FeedbackWatch::is_beyond(Signal position) {
  const uint32_t beyond = beyond_limit(position);
  const uint32_t low = load(low_);
  const uint32_t high = load(high_);
  if (beyond == 0 || low != low_seen_ || high != high_seen_) {
    beyond_at_first_ = beyond == 0 ? 0 : beyond + load(margin_);
    low_seen_ = low;
    high_seen_ = high;
  }
  return beyond > beyond_at_first_;
}

void FeedbackWatch::restart() {
  lagging_ = 0;
  beyond_ = 0;
  low_seen_ = ~load(low_);
}

}  // namespace stillpoint::firmware

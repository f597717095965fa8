// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/raised_plan.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

// The most by which a short phase may exceed a limit: one over the largest impulse. Taps in pairs are one impulse.
double largest_factor(const ShaperDesign& design) {
  double factor = 1.0;
  for (uint32_t i = 0; i < design.stage_count; ++i) {
    const Tap* taps = design.taps + design.stages[i].first_tap;
    double largest = math::magnitude(static_cast<double>(taps[0].gain));
    for (uint32_t k = 1; k + 1 < design.stages[i].tap_count; k += 2) {
      const double pair = math::magnitude(static_cast<double>(taps[k].gain) + static_cast<double>(taps[k + 1].gain));
      if (pair > largest) largest = pair;
    }
    factor *= static_cast<double>(kUnityGain) / largest;
  }
  constexpr double kLeast = 1.5;  // negative gains: impulses of one, and phases that cancel
  constexpr double kMost = 4.0;
  if (factor < kLeast) return kLeast;
  return factor < kMost ? factor : kMost;
}

[[gnu::noinline]] bool cruises(const Plan& plan, double longer_than) {
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const Segment& segment = plan.segments[i];
    if (segment.jerk == 0.0 && segment.acceleration == 0.0 && segment.duration_ticks > longer_than) return true;
  }
  return false;
}

}  // namespace

SoonestSearch::SoonestSearch(ShapedMoveCheck& check, const ShaperDesign& design, const Move& move, const Plan& plain,
                             double tick_s)
    : check_(check), move_(move), tick_s_(tick_s), most_(largest_factor(design)) {
  best_.plan = plain;
}

CheckedPlan SoonestSearch::find() {
  const Plan plain = best_.plan;
  static_cast<void>(check_.broken(plain));
  keep(plain, MoveTiming::kScaled);
  // What stays at a limit for longer than the shaper is cannot be scaled at all.
  if (sustained_limit(plain, check_.length_ticks()) == Quantity::kNone) scale();
  raise_limits();
  if (best_.timing == MoveTiming::kRaised) scale();
  best_.binding =
      best_.plan.duration_ticks > 1 ? check_.broken_at(best_.plan, best_.plan.duration_ticks - 1) : Quantity::kDuration;
  return best_;
}

void SoonestSearch::keep(const Plan& plan, MoveTiming timing) {
  best_ = CheckedPlan{plan, timing, Quantity::kNone, check_.peaks(), check_.use()};
}

void SoonestSearch::scale() {
  const uint32_t enough = best_.plan.duration_ticks;
  Quantity binding = Quantity::kNone;
  const uint32_t least = check_.least_ticks(best_.plan, 0, enough, binding);
  if (least == enough) return;
  Plan plan = best_.plan;
  if (!stretch(plan, least).ok() || check_.broken(plan) != Quantity::kNone) return;
  keep(plan, best_.timing);
}

// False also where the plan would win nothing: then a larger factor is looked for.
bool SoonestSearch::breaks(const Factors& factors) {
  AxisLimits limits = move_.limits;
  limits.velocity *= factors.velocity;
  limits.acceleration *= factors.acceleration;
  limits.deceleration *= factors.acceleration;
  limits.jerk *= factors.jerk;
  limits.deceleration_jerk *= factors.jerk;
  Plan plan{};
  if (!plan_rest_to_rest(best_.plan.distance, limits, move_.kind, tick_s_, plan, move_.detail).ok()) return true;
  if (plan.duration_ticks >= best_.plan.duration_ticks) return false;
  if (check_.broken(plan) != Quantity::kNone) return true;
  keep(plan, MoveTiming::kRaised);
  best_factors_ = factors;
  return false;
}

double SoonestSearch::largest(double Factors::*factor, const Factors& begin, double low, double high) {
  Factors factors = begin;
  constexpr int kSteps = 6;  // to 3 % of the range
  for (int step = 0; step < kSteps; ++step) {
    factors.*factor = math::sqrt(low * high);
    (breaks(factors) ? high : low) = factors.*factor;
  }
  return low;
}

void SoonestSearch::raise_limits() {
  constexpr double kLeast = 0.4;
  const bool jerk_limited = move_.jerk_limited();
  const double most_jerk = jerk_limited ? most_ * (1.0 - 1.0 / 256.0) : 1.0;
  if (jerk_limited) {
    const double jerk = largest(&Factors::jerk, {1.0, 1.0, 1.0}, 1.0, most_);
    largest(&Factors::acceleration, {1.0, 1.0, most_jerk}, kLeast, most_);
    largest(&Factors::acceleration, {1.0, 1.0, math::sqrt(jerk * most_jerk)}, kLeast, most_);
  }
  largest(&Factors::acceleration, {1.0, 1.0, 1.0}, kLeast, most_);
  if (cruises(best_.plan, 0.0) && !cruises(best_.plan, check_.length_ticks() + 3.0))
    largest(&Factors::velocity, best_factors_, best_factors_.velocity, most_);
}

}  // namespace stillpoint

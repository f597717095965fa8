// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/matched.hpp"

#include <float.h>

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

constexpr double kShortestBox = 1.0 / 1024.0;
constexpr int kMostHalves = 5;

// Of one direction, counts and ticks.
struct RampLimits {
  double acceleration;
  double jerk;
};

struct Task {
  double distance;
  double velocity;
  RampLimits ramp[2];  // up and down
};

// Two boxes whose convolution is the S-curve's ramp over `velocity`.
BoxPair plain_ramp(double velocity, const RampLimits& limits) {
  const double jerk_ticks = limits.acceleration / limits.jerk;
  const double by_acceleration = velocity / limits.acceleration;
  const double triangle = by_acceleration < jerk_ticks ? math::sqrt(velocity / limits.jerk) : 0.0;
  const bool triangular = triangle != 0.0;
  return BoxPair{{math::greater(triangular ? triangle : jerk_ticks, kShortestBox),
                  math::greater(triangular ? triangle : by_acceleration, kShortestBox)}};
}

// The box to go with one of `half` that is followed by `decay` times itself.
BoxPair matched_ramp(double velocity, const RampLimits& limits, double half, double decay) {
  const double area = half * (1.0 + decay);
  double other = math::greater(velocity / (area * limits.jerk), kShortestBox);
  // The acceleration, velocity / area while the other box is shorter than this one, falls as it comes to span both.
  const double room = limits.acceleration * area - velocity * decay;
  if (velocity > limits.acceleration * area) {
    const double spanning = room > 0.0 ? velocity * half * (1.0 - decay) / room : 2.0 * half;
    other = math::greater(other, spanning < 2.0 * half ? spanning : velocity / limits.acceleration);
  }
  return BoxPair{{half, other}};
}

double sum(const BoxPair& pair) { return pair.box[0] + pair.box[1]; }

// A move of a form at a peak velocity (of the base), in continuous time.
struct Candidate {
  MatchedShape shape;
  double ticks;
  double spare;  // of the cruise; below zero there is no such move
};

Candidate at_velocity(const Task& task, MatchedForm form, double half, double decay, double velocity) {
  const bool ramps = form == MatchedForm::kRamps;
  Candidate candidate{MatchedShape{write_matched, form, half, decay, {}}, 0.0, 0.0};
  BoxPair* ramp = candidate.shape.ramp;
  for (int i = 0; i < 2; ++i) {
    ramp[i] = ramps ? matched_ramp(velocity, task.ramp[i], half, decay) : plain_ramp(velocity, task.ramp[i]);
  }
  const double up = sum(ramp[0]);
  const double down = sum(ramp[1]);
  const double down_begins = task.distance / velocity + (up - down) / 2.0;
  candidate.ticks = half + down_begins + down;
  candidate.spare = down_begins - up - (ramps ? half : 0.0);
  return candidate;
}

// The least over the peak velocity. Where there is a cruise to spare at `right` there is at any lower velocity.
struct Search {
  const Task& task;
  MatchedForm form;
  double half;
  double decay;

  Candidate at(double velocity) const { return at_velocity(task, form, half, decay, velocity); }
  double ticks(double velocity) const { return at(velocity).ticks; }

  double fastest() const {
    if (at(task.velocity).spare >= 0.0) return task.velocity;
    double low = 0.0;
    double high = task.velocity;
    for (int i = 0; i < 1100 && (low == 0.0 || high > low * (1.0 + 1e-13)); ++i) {
      const double middle = low == 0.0 ? high / 2.0 : (low + high) / 2.0;
      (at(middle).spare >= 0.0 ? low : high) = middle;
    }
    return low;
  }

  Candidate best() const {
    constexpr int kScan = 16;
    constexpr double kGolden = 0.6180339887498949;
    const double step = fastest() / kScan;
    int nearest = kScan;
    double least = ticks(nearest * step);
    for (int i = 1; i < kScan; ++i) {
      const double other = ticks(i * step);
      if (other >= least) continue;
      least = other;
      nearest = i;
    }
    double low = (nearest - 1) * step;
    double high = (nearest < kScan ? nearest + 1 : kScan) * step;
    double inner = low + kGolden * (high - low);
    double inner_ticks = ticks(inner);
    for (int i = 0; i < 44; ++i) {
      const double other = low + (high - inner);
      const double other_ticks = ticks(other);
      const bool better = other_ticks < inner_ticks;
      ((other < inner) == better ? high : low) = better ? inner : other;
      if (!better) continue;
      inner = other;
      inner_ticks = other_ticks;
    }
    return at(inner_ticks < least ? inner : nearest * step);
  }
};

// kVelocity's ramps begin at 0, half and 2 half, up and then down: how many times the jerk of one the overlap of ramps
// that last `ramp_ticks` may reach. (Their accelerations have opposite signs, or add up to one.)
double overlap(double ramp_ticks, double half, double decay) {
  if (ramp_ticks <= half) return 1.0;
  return ramp_ticks <= 2.0 * half ? 2.0 - decay : 2.0;
}

// The velocity itself a box of `half`: V, then `decay` V; its ramps by the weaker limits, since they meet both.
Candidate velocity_form(const Task& task, double half, double decay) {
  const double velocity = task.distance / (half * (1.0 + decay));
  const RampLimits& up = task.ramp[0];
  const RampLimits& down = task.ramp[1];
  const RampLimits weaker{math::lesser(up.acceleration, down.acceleration), math::lesser(up.jerk, down.jerk)};
  BoxPair ramp{};
  double factor = 1.0;
  for (int i = 0; i < 3; ++i) {
    ramp = plain_ramp(velocity, RampLimits{weaker.acceleration, weaker.jerk / factor});
    const double reached = overlap(sum(ramp), half, decay);
    if (reached <= factor) break;
    factor = reached;
  }
  return Candidate{MatchedShape{write_matched, MatchedForm::kVelocity, half, decay, {ramp, ramp}},
                   2.0 * half + sum(ramp), task.velocity - velocity};
}

Candidate shortest(const Task& task, double half, double decay) {
  Candidate best = Search{task, MatchedForm::kShifted, half, decay}.best();
  const auto offer = [&best](const Candidate& other) {
    if (other.spare >= 0.0 && other.ticks < best.ticks) best = other;
  };
  double decay_n = 1.0;
  for (int n = 1; n <= kMostHalves; ++n) {
    decay_n *= decay;
    if (n % 2 == 0 && decay != 1.0) continue;
    offer(velocity_form(task, n * half, decay_n));
    if (task.distance / task.velocity + 2.0 * n * half >= best.ticks) continue;  // no such ramps are shorter
    offer(Search{task, MatchedForm::kRamps, n * half, decay_n}.best());
  }
  return best;
}

// --- from the shape to segments

// A ramp at its time: zero outside, so that a cruise or a stand between ramps is one to the last bit.
struct PlacedRamp {
  double at;
  double jerk_ticks;
  double ticks;
  double jerk;

  double acceleration_at(double time) const {
    const double into = math::greater(math::lesser(time - at, ticks - (time - at)), 0.0);
    return jerk * math::lesser(into, jerk_ticks);
  }
  double jerk_between(double time, double end) const {
    const double middle = (time - at) / 2.0 + (end - at) / 2.0;
    if (middle <= 0.0 || middle >= ticks) return 0.0;
    return middle < jerk_ticks ? jerk : middle > ticks - jerk_ticks ? -jerk : 0.0;
  }
};

// Rising, each once.
struct Times {
  double time[kMaxSegments + 1];
  uint32_t count = 0;

  void add(double ticks) {
    uint32_t i = count;
    while (i > 0 && time[i - 1] > ticks) --i;
    if (i > 0 && time[i - 1] == ticks) return;
    for (uint32_t k = count; k > i; --k) time[k] = time[k - 1];
    time[i] = ticks;
    ++count;
  }
  void add(const PlacedRamp& ramp) {
    const double after[] = {0.0, ramp.jerk_ticks, ramp.ticks - ramp.jerk_ticks, ramp.ticks};
    for (double ticks : after) add(ramp.at + ticks);
  }
};

void write_segments(const PlacedRamp (&ramps)[4], double end, Plan& plan) {
  Times times;
  for (const PlacedRamp& ramp : ramps) times.add(ramp);
  if (times.time[times.count - 1] < end) times.add(end);
  plan.segment_count = 0;
  for (uint32_t i = 0; i + 1 < times.count; ++i) {
    Segment& segment = plan.segments[plan.segment_count++];
    segment = Segment{times.time[i + 1] - times.time[i], 0.0, 0.0};
    for (const PlacedRamp& ramp : ramps) {
      segment.acceleration += ramp.acceleration_at(times.time[i]);
      segment.jerk += ramp.jerk_between(times.time[i], times.time[i + 1]);
    }
  }
}

// kVelocity's ramps, `ticks` long, or as long as the jerk of their overlap allows; the rest of the move it stands.
double velocity_ramp_ticks(const MatchedShape& shape, double ticks) {
  const double least = sum(shape.ramp[0]);
  const double allowed = overlap(least, shape.half, shape.decay) / (least * least);
  for (int halves = 2; halves >= 1; --halves) {
    if (overlap(ticks, shape.half, shape.decay) / (ticks * ticks) <= allowed) break;
    ticks = math::lesser(
        ticks, math::greater(halves * shape.half * (1.0 - 0x1p-40), least));  // whatever rounding does to them
  }
  return ticks;
}

// The shape as it is over another duration than its optimum.
MatchedShape shape_over(const Plan& plan, double ticks) {
  MatchedShape shape = plan.matched;
  double factor = 1.0;
  if (ticks < plan.optimum_ticks) {
    factor = ticks / plan.optimum_ticks;
    shape.half *= factor;
  } else if (shape.form == MatchedForm::kVelocity) {
    factor = velocity_ramp_ticks(shape, ticks - 2.0 * shape.half) / sum(shape.ramp[0]);
  } else if (shape.form == MatchedForm::kShifted) {
    factor = (ticks - shape.half) / (plan.optimum_ticks - shape.half);
  }
  // Whole multiples of the last bit of the duration, so that sums and differences of times are exact: a ramp of a tick
  // would else end a rounding of a thousand ticks beside its velocity. Downwards: ramps that meet do not overlap.
  const double bit = math::power_of_two(math::binary_of(ticks).exponent - math::kMantissaBits);
  const auto whole_bits = [bit](double time) { return math::floor(time / bit) * bit; };
  shape.half = whole_bits(shape.half);
  for (BoxPair& pair : shape.ramp) {
    for (double& box : pair.box) box = whole_bits(box * factor);
  }
  return shape;
}

}  // namespace

void write_matched(Plan& plan, uint32_t duration_ticks) {
  MatchedShape shape = shape_over(plan, duration_ticks);
  const bool by_velocity = shape.form == MatchedForm::kVelocity;
  const double begins = by_velocity ? shape.half : duration_ticks - shape.half - sum(shape.ramp[1]);
  // Where there is no cruise, rounding must not make the ramps overlap.
  const double overlapping = sum(shape.ramp[0]) + (shape.form == MatchedForm::kRamps ? shape.half : 0.0) - begins;
  if (overlapping > 0.0 && !by_velocity) shape.ramp[0].box[1] -= overlapping;
  const double velocity = plan.distance / (begins + (sum(shape.ramp[1]) - sum(shape.ramp[0])) / 2.0);
  PlacedRamp ramps[4];
  for (int i = 0; i < 4; ++i) {
    const BoxPair& boxes = shape.ramp[i % 2];
    const bool repeated = i >= 2;
    const double share = (repeated ? shape.decay : 1.0) / (1.0 + shape.decay);
    const double jerk = velocity * share / (boxes.box[0] * boxes.box[1]);
    ramps[i].at = (i % 2 == 0 ? 0.0 : begins) + (repeated ? shape.half : 0.0);
    ramps[i].jerk_ticks = math::lesser(boxes.box[0], boxes.box[1]);
    ramps[i].ticks = sum(boxes);
    ramps[i].jerk = i % 2 == 0 ? jerk : -jerk;
  }
  write_segments(ramps, duration_ticks, plan);
  plan.duration_ticks = duration_ticks;
}

Status plan_matched(double distance, const AxisLimits& limits, double tick_s, const ProfileDetail& detail, Plan& out) {
  const double frequency = detail.frequency_hz;
  const double damping = detail.damping_ratio;
  Status status = check_positive(Quantity::kFrequency, frequency);
  if (!status.ok()) return status;
  if (!(frequency * tick_s <= 0.5)) return refuse(Error::kAboveMaximum, Quantity::kFrequency, frequency, 0.5 / tick_s);
  status = check_finite(Quantity::kDampingRatio, damping);
  if (!status.ok()) return status;
  if (damping < 0.0) return refuse(Error::kBelowMinimum, Quantity::kDampingRatio, damping, 0.0);
  if (damping >= 1.0) return refuse(Error::kAboveMaximum, Quantity::kDampingRatio, damping, 1.0 - DBL_EPSILON);
  const double root = math::sqrt((1.0 - damping) * (1.0 + damping));
  const double half = 0.5 / (frequency * root * tick_s);
  const double decay = math::exp(-math::kPi * damping / root);
  const double tick_2 = tick_s * tick_s;
  const double tick_3 = tick_2 * tick_s;
  const Task task{math::magnitude(distance),
                  limits.velocity * tick_s,
                  {RampLimits{limits.acceleration * tick_2, limits.jerk * tick_3},
                   RampLimits{limits.deceleration * tick_2, limits.braking_jerk() * tick_3}}};
  const Candidate best = shortest(task, half, decay);
  if (!(best.ticks <= kMaxDurationTicks))
    return refuse(Error::kAboveMaximum, Quantity::kDuration, best.ticks * tick_s, kMaxDurationTicks * tick_s);
  out = Plan{};
  out.distance = distance;
  out.optimum_ticks = best.ticks;
  out.matched = best.shape;
  write_matched(out, whole_ticks(best.ticks));
  return kOk;
}

}  // namespace stillpoint

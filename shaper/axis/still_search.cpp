// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/still_search.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

constexpr double kKept = 1e-10;
constexpr double kFinest = 1e-4;  // of the first trust
constexpr double kSliverTicks = 0.25;
constexpr int kCorrections = 4;
constexpr int kStages = 6;
constexpr int kStageSteps = 5;
constexpr int kLastSteps = 40;

void raise(double& largest, double value) {
  if (value > largest) largest = value;
}

}  // namespace

StillSearch::StillSearch(const JerkSequence& plain, double plain_ticks, const StillLimits& limits, double penalty)
    : sequence_(plain), plain_ticks_(plain_ticks), limits_(limits), penalty_(penalty), mode_scale_(plain_ticks) {
  const JerkPath path(plain);
  for (size_t k = 0; k < kJerkParts; ++k) {
    raise(acceleration_scale_, path.after(k).acceleration);
    raise(velocity_scale_, path.after(k).velocity);
  }
}

void StillSearch::add_mode(const Mode& mode, double tick_s) {
  modes_[mode_count_++] = ModeWeight(mode, tick_s);
  // A linear view of a wave holds for a part of it.
  const double period = 1.0 / (mode.frequency_hz * tick_s);
  if (period < mode_scale_) mode_scale_ = period;
  if (0.2 * period < first_trust_ * plain_ticks_) first_trust_ = 0.2 * period / plain_ticks_;
}

bool StillSearch::run() {
  const JerkPath path(sequence_);
  Complex plain[kMostStillModes];
  for (size_t m = 0; m < mode_count_; ++m) plain[m] = left_in(m, path, nullptr);
  for (int stage = 1; stage <= kStages; ++stage) {
    for (size_t m = 0; m < mode_count_; ++m) goal_[m] = (1.0 - static_cast<double>(stage) / kStages) * plain[m];
    descend(stage < kStages ? kStageSteps : kLastSteps);
  }
  drop_slivers();
  return violation(sequence_) < kKept;
}

// What a mode is left with beyond its goal, in units of a change of jerk so many ticks late; with the slopes after each
// time.
Complex StillSearch::left_in(size_t mode, const JerkPath& path, Complex* slopes) const {
  Complex sum = -1.0 * goal_[mode];
  for (size_t i = 0; i <= kJerkParts; ++i) {
    const double change = (i < kJerkParts ? jerk_sign(i) : 0.0) - (i > 0 ? jerk_sign(i - 1) : 0.0);
    const double time = i < kJerkParts ? path.before(i).time : path.end().time;
    const ModeWeight::Value weight = modes_[mode].at(time * plain_ticks_, plain_ticks_);
    sum += (change / mode_scale_) * weight.value;
    if (slopes != nullptr) slopes[i] = (change * plain_ticks_ / mode_scale_) * weight.slope;
  }
  return sum;
}

double StillSearch::violation(const JerkSequence& sequence) const {
  const JerkPath path(sequence);
  const PathPoint end = path.end();
  double sum = math::magnitude(end.acceleration) + math::magnitude(end.velocity) / acceleration_scale_ +
               math::magnitude(end.position - limits_.distance) / velocity_scale_;
  if (cruise_ != 0) sum += math::magnitude(path.after(cruise_).acceleration);
  for (size_t m = 0; m < mode_count_; ++m) {
    const Complex left = left_in(m, path, nullptr);
    sum += math::magnitude(left.re) + math::magnitude(left.im);
  }
  for (size_t k = 0; k < kJerkParts; ++k) {
    double over = 0.0;
    raise(over, path.after(k).acceleration - limits_.acceleration);
    raise(over, -path.after(k).acceleration - limits_.deceleration);
    if (path.peaks_in(k)) raise(over, (path.peak_velocity(k) - limits_.velocity) / acceleration_scale_);
    sum += over;
  }
  return sum;
}

double StillSearch::merit(const JerkSequence& sequence) const {
  return sequence.total() + penalty_ * violation(sequence);
}

void StillSearch::add(SmallLp& lp, const Row& row, double right, bool equality, const Row& low) {
  for (size_t k = 0; k < kJerkParts; ++k) right -= row[k] * low[k];
  lp.add_row(row, right, equality);
}

void StillSearch::add_end(SmallLp& lp, const JerkPath& path, const Row& low) const {
  Row acceleration = {};
  Row velocity = {};
  Row position = {};
  const PathPoint end = path.end();
  for (size_t k = 0; k < kJerkParts; ++k) {
    const PathPoint more = path.effect(k, end.time);
    acceleration[k] = more.acceleration;
    velocity[k] = more.velocity / acceleration_scale_;
    position[k] = more.position / velocity_scale_;
  }
  add(lp, acceleration, -end.acceleration, true, low);
  add(lp, velocity, -end.velocity / acceleration_scale_, true, low);
  add(lp, position, (limits_.distance - end.position) / velocity_scale_, true, low);
  if (cruise_ == 0) return;
  Row until_cruise = {};
  for (size_t k = 0; k <= cruise_; ++k) until_cruise[k] = jerk_sign(k);
  add(lp, until_cruise, -path.after(cruise_).acceleration, true, low);
}

void StillSearch::add_modes(SmallLp& lp, const JerkPath& path, const Row& low) const {
  for (size_t m = 0; m < mode_count_; ++m) {
    Complex slopes[kJerkParts + 1];
    const Complex left = left_in(m, path, slopes);
    Row re;
    Row im;
    Complex later{};
    for (size_t k = kJerkParts; k-- > 0;) {
      later += slopes[k + 1];
      re[k] = later.re;
      im[k] = later.im;
    }
    add(lp, re, -left.re, true, low);
    add(lp, im, -left.im, true, low);
  }
}

void StillSearch::add_limits(SmallLp& lp, const JerkPath& path, const Row& low) const {
  for (size_t k = 0; k < kJerkParts; ++k) {
    Row row = {};
    const bool rises = jerk_sign(k) > 0.0;
    if (jerk_sign(k) != 0.0 && k + 1 < kJerkParts) {
      for (size_t i = 0; i <= k; ++i) row[i] = rises ? jerk_sign(i) : -jerk_sign(i);
      const double now = path.after(k).acceleration;
      add(lp, row, rises ? limits_.acceleration - now : limits_.deceleration + now, false, low);
    }
    if (!path.peaks_in(k)) continue;
    const double time = path.before(k).time + path.before(k).acceleration;
    for (size_t i = 0; i < kJerkParts; ++i) {
      row[i] = i < k ? path.effect(i, time).velocity / acceleration_scale_ : 0.0;
    }
    add(lp, row, (limits_.velocity - path.peak_velocity(k)) / acceleration_scale_, false, low);
  }
}

// A step along the tangent leaves the curve, so it is brought back before it is judged.
void StillSearch::descend(int steps) {
  double trust = first_trust_;
  sequence_ = corrected(sequence_, trust);
  double least = merit(sequence_);
  for (int i = 0; i < steps && trust > kFinest * first_trust_; ++i) {
    const JerkSequence next = corrected(stepped(sequence_, trust), trust);
    const double now = merit(next);
    if (!(now < least)) {
      trust *= 0.4;
      continue;
    }
    double longest = 0.0;
    for (size_t k = 0; k < kJerkParts; ++k) raise(longest, math::magnitude(next.length[k] - sequence_.length[k]));
    if (longest > 0.5 * trust) trust *= 2.0;
    sequence_ = next;
    least = now;
  }
  sequence_ = corrected(sequence_, trust);
}

// What a few hundredths of a tick do the other parts can do too.
void StillSearch::drop_slivers() {
  if (!(violation(sequence_) < kKept)) return;
  const JerkSequence before = sequence_;
  for (int round = 0; round < 2; ++round) {
    for (size_t k = 0; k < kJerkParts; ++k) {
      if (sequence_.length[k] * plain_ticks_ < kSliverTicks) dropped_[k] = true;
      if (dropped_[k]) sequence_.length[k] = 0.0;
    }
    sequence_ = corrected(sequence_, first_trust_);
  }
  if (!(violation(sequence_) < kKept)) sequence_ = before;
}

// Near where it is.
JerkSequence StillSearch::corrected(const JerkSequence& sequence, double trust) const {
  JerkSequence result = sequence;
  double left = violation(result);
  for (int i = 0; i < kCorrections && left > kKept; ++i) {
    const JerkSequence next = stepped(result, 4.0 * left < trust ? 4.0 * left : trust);
    const double now = violation(next);
    if (!(now < left)) break;
    result = next;
    left = now;
  }
  return result;
}

JerkSequence StillSearch::stepped(const JerkSequence& sequence, double trust) const {
  const JerkPath path(sequence);
  SmallLp lp(kJerkParts, penalty_);
  Row low;
  for (size_t k = 0; k < kJerkParts; ++k) {
    low[k] = sequence.length[k] < trust ? -sequence.length[k] : -trust;
    lp.set(k, 1.0, dropped_[k] ? 0.0 : trust - low[k]);
  }
  add_end(lp, path, low);
  add_modes(lp, path, low);
  add_limits(lp, path, low);
  double change[kJerkParts];
  lp.solve(change);
  JerkSequence next = sequence;
  for (size_t k = 0; k < kJerkParts; ++k) {
    next.length[k] += low[k] + change[k];
    if (next.length[k] < 0.0 || (change[k] == 0.0 && low[k] > -trust)) next.length[k] = 0.0;
  }
  return next;
}

}  // namespace stillpoint

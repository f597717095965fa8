// SPDX-License-Identifier: Apache-2.0
#include "shaper/axis/still_plan.hpp"

#include "shaper/base/complex.hpp"
#include "shaper/base/math.hpp"
#include "shaper/base/small_lp.hpp"

namespace stillpoint {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr size_t kCount = SmallLp::kMaxVariables;  // + 0 - 0, five times, and a last +
constexpr double kPenalty = 30.0;                  // a unit of what is not kept, against a unit of time
constexpr double kKept = 1e-12;
constexpr double kFinest = 1e-4;  // of the first trust
constexpr double kSliverTicks = 0.25;
constexpr int kCorrections = 4;
constexpr int kStages = 6;
constexpr int kStageSteps = 5;
constexpr int kLastSteps = 25;

double sign_of(size_t k) {
  if (k % 2 == 1) return 0.0;
  return k % 4 == 0 ? 1.0 : -1.0;
}

// Lengths of the sequence, in plain durations.
struct Lengths {
  double of[kCount];
};

double total(const Lengths& lengths) {
  double sum = 0.0;
  for (size_t k = 0; k < kCount; ++k) sum += lengths.of[k];
  return sum;
}

// The move at the end of each part. Units: jerk 1, time the plain duration.
struct Motion {
  double time;
  double acceleration;
  double velocity;
  double position;
};

struct Path {
  Motion after[kCount];
  Motion before(size_t k) const { return k == 0 ? Motion{} : after[k - 1]; }
};

Path path_of(const Lengths& lengths) {
  Path path{};
  Motion m{};
  for (size_t k = 0; k < kCount; ++k) {
    const double t = lengths.of[k];
    const double j = sign_of(k);
    m.position += t * (m.velocity + t * (m.acceleration / 2.0 + t * j / 6.0));
    m.velocity += t * (m.acceleration + t * j / 2.0);
    m.acceleration += t * j;
    m.time += t;
    path.after[k] = m;
  }
  return path;
}

// A mode, by what a change of jerk by one at a time between ticks adds to its transform over the ticks: the third
// difference of the samples, c0, c1, c2 and ever 1, each times exp(exponent tick).
struct Weight {
  Complex value;
  Complex slope;  // a tick
};

class ModeWeights {
 public:
  ModeWeights() = default;
  ModeWeights(const Mode& mode, double tick_s) {
    const double w = 2.0 * kPi * mode.frequency_hz * tick_s;
    exponent_ = Complex{mode.damping_ratio * w, -w * math::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio)};
    one_ = math::exp(exponent_);
    two_ = one_ * one_;
    rest_ = two_ * one_ / (Complex{1.0, 0.0} - one_);
  }

  // Counted from `end`, about where the move does and the vibration would be largest: nothing overflows.
  Weight at(double ticks, double end) const {
    const double first = math::ceil(ticks);
    const double f = first - ticks;
    const double g = 1.0 + f;
    const double h = 2.0 + f;
    const Complex turn = math::exp((first - end) * exponent_);
    const double c0 = f * f * f / 6.0;
    const double c1 = (g * g * g - 3.0 * f * f * f) / 6.0;
    const double c2 = (h * h * h - 3.0 * g * g * g + 3.0 * f * f * f) / 6.0;
    const double s0 = f * f / -2.0;
    const double s1 = (g * g - 3.0 * f * f) / -2.0;
    const double s2 = (h * h - 3.0 * g * g + 3.0 * f * f) / -2.0;
    return Weight{turn * (Complex{c0, 0.0} + c1 * one_ + c2 * two_ + rest_),
                  turn * (Complex{s0, 0.0} + s1 * one_ + s2 * two_)};
  }

 private:
  Complex exponent_ = {};
  Complex one_ = {};
  Complex two_ = {};
  Complex rest_ = {};
};

class StillSearch {
 public:
  // Limits over the distance 1, in ticks; `plain_ticks` long is the plain move.
  StillSearch(const Lengths& plain, double plain_ticks, double velocity, double acceleration, double deceleration,
              double distance)
      : lengths_(plain),
        plain_ticks_(plain_ticks),
        mode_scale_(plain_ticks),
        velocity_(velocity),
        acceleration_(acceleration),
        deceleration_(deceleration),
        distance_(distance) {
    const Path path = path_of(plain);
    for (const Motion& m : path.after) {
      raise(acceleration_scale_, m.acceleration);
      raise(velocity_scale_, m.velocity);
    }
  }

  void add_mode(const Mode& mode, double tick_s) {
    modes_[mode_count_++] = ModeWeights(mode, tick_s);
    // A linear view of a wave holds for a part of it.
    const double period = 1.0 / (mode.frequency_hz * tick_s);
    if (period < mode_scale_) mode_scale_ = period;
    if (0.2 * period < first_trust_ * plain_ticks_) first_trust_ = 0.2 * period / plain_ticks_;
  }

  // True if everything is kept at the end of it. The plain move is the best that leaves the modes what it leaves them;
  // from there it is led to what leaves them nothing.
  bool run() {
    const Path path = path_of(lengths_);
    Complex plain[kMostStillModes];
    for (size_t m = 0; m < mode_count_; ++m) plain[m] = left_in(m, path, nullptr);
    for (int stage = 1; stage <= kStages; ++stage) {
      for (size_t m = 0; m < mode_count_; ++m) goal_[m] = (1.0 - static_cast<double>(stage) / kStages) * plain[m];
      descend(stage < kStages ? kStageSteps : kLastSteps);
    }
    drop_slivers();
    return violation(lengths_) < kKept;
  }

  // Part `k` is a cruise: at no acceleration, however little of it would do over so long a time.
  void hold(size_t k) { cruise_ = k; }

  const Lengths& lengths() const { return lengths_; }

 private:
  static void raise(double& largest, double value) {
    if (value > largest) largest = value;
  }

  // Where the speed is largest, or a cruise: in falling acceleration, as it passes zero.
  static bool peaks_in(const Path& path, size_t k) {
    return k % 4 == 2 && path.before(k).acceleration >= 0.0 && path.after[k].acceleration <= 0.0;
  }
  static double peak_velocity(const Path& path, size_t k) {
    const Motion m = path.before(k);
    return m.velocity + m.acceleration * m.acceleration / 2.0;
  }

  // What mode m is left with beyond its goal, in units of a change of jerk so many ticks late; with the slopes after each time.
  Complex left_in(size_t m, const Path& path, Complex* slopes) const {
    Complex sum = -1.0 * goal_[m];
    for (size_t i = 0; i <= kCount; ++i) {
      const double change = (i < kCount ? sign_of(i) : 0.0) - (i > 0 ? sign_of(i - 1) : 0.0);
      const double time = i < kCount ? path.before(i).time : path.after[kCount - 1].time;
      const Weight weight = modes_[m].at(time * plain_ticks_, plain_ticks_);
      sum += (change / mode_scale_) * weight.value;
      if (slopes != nullptr) slopes[i] = (change * plain_ticks_ / mode_scale_) * weight.slope;
    }
    return sum;
  }

  double violation(const Lengths& lengths) const {
    const Path path = path_of(lengths);
    const Motion end = path.after[kCount - 1];
    double sum = math::abs(end.acceleration) + math::abs(end.velocity) / acceleration_scale_ +
                 math::abs(end.position - distance_) / velocity_scale_;
    if (cruise_ != 0) sum += math::abs(path.after[cruise_].acceleration);
    for (size_t m = 0; m < mode_count_; ++m) {
      const Complex left = left_in(m, path, nullptr);
      sum += math::abs(left.re) + math::abs(left.im);
    }
    for (size_t k = 0; k < kCount; ++k) {
      double over = 0.0;
      raise(over, path.after[k].acceleration - acceleration_);
      raise(over, -path.after[k].acceleration - deceleration_);
      if (peaks_in(path, k)) raise(over, (peak_velocity(path, k) - velocity_) / acceleration_scale_);
      sum += over;
    }
    return sum;
  }

  // A row in the changes of the lengths; those begin at `low`.
  static void add(SmallLp& lp, const double* row, double right, bool equality, const double* low) {
    for (size_t k = 0; k < kCount; ++k) right -= row[k] * low[k];
    lp.add_row(row, right, equality);
  }

  // What a longer part k does to acceleration, velocity and position at a later `time`.
  static Motion effect(const Path& path, size_t k, double time) {
    const Motion& m = path.after[k];
    const double j = sign_of(k);
    const double rest = time - m.time;
    return Motion{1.0, j, m.acceleration + j * rest, m.velocity + rest * (m.acceleration + rest * j / 2.0)};
  }

  void add_end(SmallLp& lp, const Path& path, const double* low) const {
    double rows[3][kCount];
    const Motion end = path.after[kCount - 1];
    for (size_t k = 0; k < kCount; ++k) {
      const Motion more = effect(path, k, end.time);
      rows[0][k] = more.acceleration;
      rows[1][k] = more.velocity / acceleration_scale_;
      rows[2][k] = more.position / velocity_scale_;
    }
    add(lp, rows[0], -end.acceleration, true, low);
    add(lp, rows[1], -end.velocity / acceleration_scale_, true, low);
    add(lp, rows[2], (distance_ - end.position) / velocity_scale_, true, low);
    if (cruise_ == 0) return;
    double row[kCount] = {};
    for (size_t k = 0; k <= cruise_; ++k) row[k] = sign_of(k);
    add(lp, row, -path.after[cruise_].acceleration, true, low);
  }

  void add_modes(SmallLp& lp, const Path& path, const double* low) const {
    for (size_t m = 0; m < mode_count_; ++m) {
      Complex slopes[kCount + 1];
      const Complex left = left_in(m, path, slopes);
      double re[kCount];
      double im[kCount];
      Complex later{};
      for (size_t k = kCount; k-- > 0;) {
        later += slopes[k + 1];
        re[k] = later.re;
        im[k] = later.im;
      }
      add(lp, re, -left.re, true, low);
      add(lp, im, -left.im, true, low);
    }
  }

  void add_limits(SmallLp& lp, const Path& path, const double* low) const {
    for (size_t k = 0; k < kCount; ++k) {
      double row[kCount] = {};
      const bool rises = sign_of(k) > 0.0;
      if (sign_of(k) != 0.0 && k + 1 < kCount) {
        for (size_t i = 0; i <= k; ++i) row[i] = rises ? sign_of(i) : -sign_of(i);
        const double now = path.after[k].acceleration;
        add(lp, row, rises ? acceleration_ - now : deceleration_ + now, false, low);
      }
      if (!peaks_in(path, k)) continue;
      const double time = path.before(k).time + path.before(k).acceleration;
      for (size_t i = 0; i < kCount; ++i) {
        row[i] = i < k ? effect(path, i, time).velocity / acceleration_scale_ : 0.0;
      }
      add(lp, row, (velocity_ - peak_velocity(path, k)) / acceleration_scale_, false, low);
    }
  }

  // A step along the tangent leaves the curve, so it is brought back before it is judged.
  void descend(int steps) {
    double trust = first_trust_;
    lengths_ = corrected(lengths_, trust);
    double merit = merit_of(lengths_);
    for (int i = 0; i < steps && trust > kFinest * first_trust_; ++i) {
      const Lengths next = corrected(stepped(lengths_, trust), trust);
      const double next_merit = merit_of(next);
      if (!(next_merit < merit)) {
        trust *= 0.4;
        continue;
      }
      double longest = 0.0;
      for (size_t k = 0; k < kCount; ++k) raise(longest, math::abs(next.of[k] - lengths_.of[k]));
      if (longest > 0.5 * trust) trust *= 2.0;
      lengths_ = next;
      merit = next_merit;
    }
    lengths_ = corrected(lengths_, trust);
  }

  // What a few hundredths of a tick do the other parts can do too.
  void drop_slivers() {
    if (!(violation(lengths_) < kKept)) return;
    const Lengths before = lengths_;
    for (int round = 0; round < 2; ++round) {
      for (size_t k = 0; k < kCount; ++k) {
        if (lengths_.of[k] * plain_ticks_ < kSliverTicks) dropped_[k] = true;
        if (dropped_[k]) lengths_.of[k] = 0.0;
      }
      lengths_ = corrected(lengths_, first_trust_);
    }
    if (!(violation(lengths_) < kKept)) lengths_ = before;
  }

  double merit_of(const Lengths& lengths) const { return total(lengths) + kPenalty * violation(lengths); }

  // Near where it is.
  Lengths corrected(const Lengths& lengths, double trust) const {
    Lengths result = lengths;
    double left = violation(result);
    for (int i = 0; i < kCorrections && left > kKept; ++i) {
      const Lengths next = stepped(result, 4.0 * left < trust ? 4.0 * left : trust);
      const double now = violation(next);
      if (!(now < left)) break;
      result = next;
      left = now;
    }
    return result;
  }

  Lengths stepped(const Lengths& lengths, double trust) const {
    const Path path = path_of(lengths);
    SmallLp lp(kCount, kPenalty);
    double low[kCount];
    for (size_t k = 0; k < kCount; ++k) {
      low[k] = lengths.of[k] < trust ? -lengths.of[k] : -trust;
      lp.set(k, 1.0, dropped_[k] ? 0.0 : trust - low[k]);
    }
    add_end(lp, path, low);
    add_modes(lp, path, low);
    add_limits(lp, path, low);
    double change[kCount];
    lp.solve(change);
    Lengths next = lengths;
    for (size_t k = 0; k < kCount; ++k) {
      next.of[k] += low[k] + change[k];
      if (next.of[k] < 0.0 || (change[k] == 0.0 && low[k] > -trust)) next.of[k] = 0.0;
    }
    return next;
  }

  Lengths lengths_;
  double plain_ticks_;
  double first_trust_ = 0.1;
  double mode_scale_;  // ticks: a part of a plain duration, or of a period
  double velocity_;
  double acceleration_;
  double deceleration_;
  double distance_;
  double acceleration_scale_ = 0.0;
  double velocity_scale_ = 0.0;
  size_t cruise_ = 0;
  bool dropped_[kCount] = {};
  size_t mode_count_ = 0;
  ModeWeights modes_[kMostStillModes] = {};
  Complex goal_[kMostStillModes] = {};
};

// The plain S-curve: speeding up in the first round of the sequence, slowing down from round `down` on.
Lengths written(const Plan& plain, size_t cruise, size_t down) {
  Lengths lengths{};
  bool slowing = false;
  for (size_t i = 0; i < plain.segment_count; ++i) {
    const Segment& segment = plain.segments[i];
    const double t = segment.duration_ticks / plain.optimum_ticks;
    const bool forward = plain.distance > 0.0;
    const bool rises = (segment.jerk > 0.0) == forward;
    if (segment.jerk == 0.0) {
      if (segment.acceleration == 0.0) {
        lengths.of[cruise] = t;
        continue;
      }
      lengths.of[(segment.acceleration > 0.0) == forward ? 1 : 4 * down + 3] = t;
      continue;
    }
    if (rises) lengths.of[slowing ? 4 * (down + 1) : 0] = t;
    if (!rises && !slowing) {
      const bool ends = segment.acceleration != 0.0;
      lengths.of[ends ? 2 : 4 * down + 2] = t;
      slowing = !ends;
    }
  }
  return lengths;
}

// False if there are too many parts.
bool write_plan(const Lengths& lengths, double plain_ticks, double jerk, double distance, Plan& out) {
  Plan plan{};
  plan.distance = distance;
  double acceleration = 0.0;
  double ticks = 0.0;
  for (size_t k = 0; k < kCount; ++k) {
    const double t = lengths.of[k] * plain_ticks;
    if (t <= 0.0) continue;
    const double j = sign_of(k) * jerk;
    const bool goes_on = plan.segment_count > 0 && plan.segments[plan.segment_count - 1].jerk == j;
    if (plan.segment_count + 1 >= kMaxSegments && !goes_on) return false;
    if (goes_on) {
      plan.segments[plan.segment_count - 1].duration_ticks += t;
    } else {
      plan.segments[plan.segment_count++] = Segment{t, acceleration, j};
    }
    acceleration += j * t;
    ticks += t;
  }
  plan.optimum_ticks = ticks;
  plan.duration_ticks = whole_ticks(ticks);
  plan.segments[plan.segment_count++] = Segment{plan.duration_ticks - ticks, 0.0, 0.0};
  out = plan;
  return true;
}

bool keeps(const Plan& plan, const AxisLimits& limits, double tick_s) {
  const double sign = plan.distance > 0.0 ? 1.0 : -1.0;
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const double acceleration = sign * plan.segments[i].acceleration / (tick_s * tick_s);
    if (acceleration > limits.acceleration || -acceleration > limits.deceleration) return false;
  }
  return peaks_of(plan, tick_s).velocity <= limits.velocity;
}

}  // namespace

Status plan_still(double distance, const AxisLimits& limits, const Mode* modes, size_t mode_count, double tick_s,
                  Plan& out) {
  AxisLimits used = limits;
  if (limits.braking_jerk() < limits.jerk) used.jerk = limits.braking_jerk();
  used.deceleration_jerk = 0.0;
  // Room for what is kept to 1e-12 of other units than the limit's.
  constexpr double kRoom = 1.0 - 1e-9;
  used.velocity *= kRoom;
  used.acceleration *= kRoom;
  used.deceleration *= kRoom;
  Plan plain{};
  const Status status = plan_rest_to_rest(distance, used, ProfileKind::kSCurve, tick_s, plain);
  if (!status.ok()) return status;
  if (mode_count == 0 || mode_count > kMostStillModes)
    return refuse(Error::kNotAvailable, Quantity::kStages, static_cast<double>(mode_count), kMostStillModes);
  for (size_t m = 0; m < mode_count; ++m) {
    const Status valid = modes[m].validate();
    if (!valid.ok()) return valid;
  }
  if (distance == 0.0) {
    out = plain;
    return kOk;
  }
  const double t = plain.optimum_ticks;
  const double jerk = used.jerk * tick_s * tick_s * tick_s;
  const double per_jerk = 1.0 / jerk;
  constexpr size_t kPlaces[kStillStarts][2] = {{3, 1}, {3, 2}, {3, 3}, {7, 2}, {7, 3}, {11, 3}};
  bool found = false;
  Plan best{};
  for (const auto& place : kPlaces) {
    StillSearch search(written(plain, place[0], place[1]), t, used.velocity * tick_s * per_jerk / (t * t),
                       used.acceleration * tick_s * tick_s * per_jerk / t,
                       used.deceleration * tick_s * tick_s * per_jerk / t,
                       math::abs(distance) * per_jerk / (t * t * t));
    for (size_t m = 0; m < mode_count; ++m) search.add_mode(modes[m], tick_s);
    if (search.lengths().of[place[0]] > 0.25) search.hold(place[0]);
    Plan plan{};
    if (!search.run() || !write_plan(search.lengths(), t, distance > 0.0 ? jerk : -jerk, distance, plan)) continue;
    if (!keeps(plan, limits, tick_s)) continue;
    if (!found || plan.optimum_ticks < best.optimum_ticks) best = plan;
    found = true;
  }
  if (!found) return refuse(Error::kNotAvailable, Quantity::kFrequency, modes[0].frequency_hz);
  out = best;
  return kOk;
}

}  // namespace stillpoint

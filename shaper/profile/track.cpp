// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/track.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

Wide wide(double counts) { return wide_from_double(counts, kTrackFractionBits); }

// The entry for `tick`, new if there is none; calls come with rising ticks, or with one that exists.
Differences& at(Track& track, uint32_t tick) {
  uint32_t i = track.switch_count;
  while (i > 0 && track.switches[i - 1].tick > tick) --i;
  if (i > 0 && track.switches[i - 1].tick == tick) return track.switches[i - 1].add;
  for (uint32_t k = track.switch_count; k > i; --k) track.switches[k] = track.switches[k - 1];
  ++track.switch_count;
  track.switches[i] = Switch{tick, {}};
  return track.switches[i].add;
}

// A time between ticks: `first` is the first tick not before it, `fraction` the part of a tick from it to there. Whole
// ticks apart from the rest: a short phase of high jerk keeps the digits of its duration however late it begins.
struct Moment {
  uint32_t first;
  double fraction;
};

Moment after(const Moment& moment, double ticks) {
  const double late = ticks - moment.fraction;
  const double whole = math::ceil(late);
  return Moment{moment.first + static_cast<uint32_t>(whole), whole - late};
}

Moment before(const Moment& moment, double ticks) {
  const double early = moment.fraction + ticks;
  const double whole = math::floor(early);
  return whole <= moment.first ? Moment{moment.first - static_cast<uint32_t>(whole), early - whole} : Moment{0, 0.0};
}

// From the moment on, the samples have dv t + da t^2/2 + dj t^3/6 more.
void add_change(Track& track, const Moment& moment, double dv, double da, double dj) {
  const double f = moment.fraction;
  Differences& add = at(track, moment.first);
  add.difference[0] += wide(dv * f + da * (f * f / 2.0) + dj * (f * f * f / 6.0));
  add.difference[1] += wide(dv) + wide(da * (f + 0.5)) + wide(dj * ((3.0 * f * (f + 1.0) + 1.0) / 6.0));
  add.difference[2] += wide(da) + wide(dj) + wide(dj * f);
  add.difference[3] += wide(dj);
}

// Where segment i begins. Measured from the nearer end of the longest segment, which takes what rounding leaves.
class Times {
 public:
  explicit Times(const Plan& plan) : plan_(plan) {
    for (uint32_t i = 1; i < plan.segment_count; ++i) {
      if (plan.segments[i].duration_ticks > plan.segments[longest_].duration_ticks) longest_ = i;
    }
  }
  Moment at(uint32_t segment) const {
    const Moment end{plan_.duration_ticks, 0.0};
    Moment moment = end;
    if (segment > longest_) {
      for (uint32_t i = plan_.segment_count; i > segment; --i) moment = before(moment, ticks(i - 1));
      return moment;
    }
    moment = Moment{0, 0.0};
    for (uint32_t i = 0; i < segment; ++i) moment = after(moment, ticks(i));
    return moment.first <= end.first ? moment : end;
  }

 private:
  double ticks(uint32_t segment) const { return plan_.segments[segment].duration_ticks; }

  const Plan& plan_;
  uint32_t longest_ = 0;
};

// A segment this short whose acceleration begins with a step is a step of the velocity in its middle: its acceleration
// would be subtracted again at once.
constexpr double kStepTicks = 1.0 / 1024.0;

// Where the acceleration is continuous its two figures differ by rounding, which must not become a step.
double step_between(double before, double after) {
  const double step = after - before;
  const double larger = math::abs(before) > math::abs(after) ? before : after;
  return math::abs(step) <= 1e-9 * math::abs(larger) ? 0.0 : step;
}

// `acceleration` and `jerk`: of the start, counts/tick^n.
void add_segments(Track& track, const Plan& plan, double acceleration, double jerk) {
  const Times times(plan);
  for (uint32_t i = 0; i < plan.segment_count; ++i) {
    const Segment& segment = plan.segments[i];
    const double ticks = segment.duration_ticks;
    if (ticks < kStepTicks && segment.jerk == 0.0 && segment.acceleration != 0.0 &&
        step_between(acceleration, segment.acceleration) != 0.0) {
      add_change(track, after(times.at(i), ticks / 2.0), segment.acceleration * ticks, 0.0, 0.0);
      continue;
    }
    add_change(track, times.at(i), 0.0, step_between(acceleration, segment.acceleration), segment.jerk - jerk);
    acceleration = segment.acceleration + segment.jerk * ticks;
    jerk = segment.jerk;
  }
  const double step = jerk == 0.0 ? -acceleration : 0.0;
  add_change(track, Moment{plan.duration_ticks, 0.0}, 0.0, step, -jerk);
}

// n (n-1) / 2 and n (n-1) (n-2) / 6, exactly.
Wide pairs(uint64_t n) { return n % 2 == 0 ? multiply(n / 2, n - 1) : multiply(n, (n - 1) / 2); }

Wide triples(uint64_t n) {
  if (n < 3) return Wide{0, 0};
  const uint64_t two = pairs(n).low;  // n < 2^31
  return (n - 2) % 3 == 0 ? multiply(two, (n - 2) / 3) : multiply(two / 3, n - 2);
}

// Exactly what `ticks` ticks of adding do.
void advance(Differences& state, uint32_t ticks) {
  const Wide one = Wide::from_int(ticks);
  const Wide two = pairs(ticks);
  Wide* d = state.difference;
  d[0] += one * d[1] + two * d[2] + triples(ticks) * d[3];
  d[1] += one * d[2] + two * d[3];
  d[2] += one * d[3];
}

// The state that the switches up to `tick` and the ticks between them lead to.
Differences added_up(const Track& track, uint32_t tick, uint32_t& next_switch) {
  Differences state = track.start;
  uint32_t reached = 0;
  next_switch = 0;
  while (next_switch < track.switch_count && track.switches[next_switch].tick <= tick) {
    const Switch& next = track.switches[next_switch++];
    advance(state, next.tick - reached);
    reached = next.tick;
    for (int k = 0; k < 4; ++k) state.difference[k] += next.add.difference[k];
  }
  advance(state, tick - reached);
  return state;
}

// Where the track ends, without the last snap to the target.
Differences end_of(const Track& track) {
  uint32_t unused = 0;
  return added_up(track, track.duration_ticks, unused);
}

// What a third difference of 1 over the ticks [begin, end) leaves at `duration`, in powers of the duration.
struct Effect {
  double position;
  double velocity;
  double acceleration;
};

Effect effect_of(double begin, double end, double duration) {
  const double m = end - begin;
  const double r = duration - end;
  const double m_2 = m * (m - 1.0) / 2.0;
  return Effect{(m_2 * (m - 2.0) / 3.0 + m_2 * r + m * r * (r - 1.0) / 2.0) / (duration * duration * duration),
                (m_2 + m * r) / (duration * duration), m / duration};
}

double determinant(const Effect& a, const Effect& b, const Effect& c) {
  return a.position * (b.velocity * c.acceleration - c.velocity * b.acceleration) -
         b.position * (a.velocity * c.acceleration - c.velocity * a.acceleration) +
         c.position * (a.velocity * b.acceleration - b.velocity * a.acceleration);
}

// Three constant third differences, one over each third of the move, that take out what is missing at its end.
void correct_end(Track& track) {
  constexpr uint32_t kShortest = 12;  // below, what is missing is under an LSB or under 1e-13 of the limits
  const uint32_t n = track.duration_ticks;
  if (n < kShortest) return;
  const Differences end = end_of(track);
  const double n_d = n;
  const Effect missing{to_double(track.end.difference[0] - end.difference[0], kTrackFractionBits) / (n_d * n_d * n_d),
                       to_double(-end.difference[1], kTrackFractionBits) / (n_d * n_d),
                       to_double(-end.difference[2], kTrackFractionBits) / n_d};
  const uint32_t cut[4] = {0, n / 3, n - n / 3, n};
  Effect third[3];
  for (int i = 0; i < 3; ++i) third[i] = effect_of(cut[i], cut[i + 1], n_d);
  const double whole = determinant(third[0], third[1], third[2]);
  const Wide u[3] = {wide(determinant(missing, third[1], third[2]) / whole),
                     wide(determinant(third[0], missing, third[2]) / whole),
                     wide(determinant(third[0], third[1], missing) / whole)};
  Wide before{0, 0};
  for (int i = 0; i < 3; ++i) {
    at(track, cut[i]).difference[3] += u[i] - before;
    before = u[i];
  }
}

void make_switches(const Plan& plan, const Differences& start, double acceleration, double jerk, Track& out) {
  out.start = start;
  out.end = start;
  out.duration_ticks = plan.duration_ticks;
  out.switch_count = 0;
  if (plan.duration_ticks != 0) add_segments(out, plan, acceleration, jerk);
}

void end_at(Signal target, Track& track) {
  track.end = standing(target);
  if (track.duration_ticks != 0) correct_end(track);
}

double to_counts(Wide wide) { return to_double(wide, kTrackFractionBits); }

double acceleration_of(const Differences& state) { return to_counts(state.difference[2] - state.difference[3]); }

}  // namespace

StartMotion motion_of(const Differences& state, double tick_s) {
  const double jerk = to_counts(state.difference[3]);
  const double velocity = to_counts(state.difference[1]) - to_counts(state.difference[2]) / 2.0 + jerk / 3.0;
  return StartMotion{velocity / tick_s, acceleration_of(state) / (tick_s * tick_s)};
}

void Track::make(const Plan& plan, Signal start, Signal target, Track& out) {
  Differences moving = standing(start);
  moving.difference[1] = wide(plan.start_velocity);
  make_switches(plan, moving, 0.0, 0.0, out);
  end_at(target, out);
}

void Track::make_from(const Plan& plan, const Differences& start, Signal target, Track& out) {
  make_switches(plan, start, acceleration_of(start), to_counts(start.difference[3]), out);
  end_at(target, out);
}

void Track::make_cruise(const Plan& plan, const Differences& start, double velocity, Track& out) {
  make_switches(plan, start, acceleration_of(start), to_counts(start.difference[3]), out);
  const Differences end = end_of(out);
  if (velocity == 0.0) return end_at(signal_of(end), out);
  out.end = Differences{{end.difference[0], wide(velocity)}};
}

void Track::make_uncorrected(const Plan& plan, Signal start, Track& out) {
  Differences moving = standing(start);
  moving.difference[1] = wide(plan.start_velocity);
  make_switches(plan, moving, 0.0, 0.0, out);
  out.end = standing(static_cast<Signal>(end_of(out).difference[0].high));
}

Differences Track::differences_at(uint64_t tick, uint32_t& next_switch) const {
  if (tick < duration_ticks) return added_up(*this, static_cast<uint32_t>(tick), next_switch);
  next_switch = switch_count;
  Differences state = end;
  state.difference[0] += Wide{tick - duration_ticks, 0} * end.difference[1];
  return state;
}

}  // namespace stillpoint

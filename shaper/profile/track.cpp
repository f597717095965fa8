// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/track.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

Wide wide(double counts) { return wide_from_double(counts, kTrackFractionBits); }

double to_counts(const Wide& wide) { return to_double(wide, kTrackFractionBits); }

[[gnu::noinline]] void swap(double (&a)[3], double (&b)[3]) {
  for (int i = 0; i < 3; ++i) {
    const double was = a[i];
    a[i] = b[i];
    b[i] = was;
  }
}

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

// `ticks` may be negative.
[[gnu::noinline]] Moment after(const Moment& moment, double ticks) {
  const double late = ticks - moment.fraction;
  int32_t whole = static_cast<int32_t>(late);
  if (whole < late) ++whole;
  return Moment{moment.first + static_cast<uint32_t>(whole), whole - late};
}

void add(Wide& sum, double counts) { sum += wide(counts); }

// From the moment on, the samples have dv t + da t^2/2 + dj t^3/6 more.
[[gnu::noinline]] void add_change(Track& track, const Moment& moment, double dv, double da, double dj) {
  const double f = moment.fraction;
  Wide* d = at(track, moment.first).difference;
  add(d[0], dv * f + da * (f * f / 2.0) + dj * (f * f * f / 6.0));
  add(d[1], dv);
  add(d[1], da * (f + 0.5));
  add(d[1], dj * ((3.0 * f * (f + 1.0) + 1.0) / 6.0));
  add(d[2], da);
  add(d[2], dj);
  add(d[2], dj * f);
  add(d[3], dj);
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
    const bool backwards = segment > longest_;
    Moment moment{backwards ? plan_.duration_ticks : 0, 0.0};
    for (uint32_t i = backwards ? plan_.segment_count : 0; i != segment; i += backwards ? 0 : 1) {
      const double ticks = plan_.segments[backwards ? --i : i].duration_ticks;
      moment = after(moment, backwards ? -ticks : ticks);
    }
    if (moment.first <= plan_.duration_ticks) return moment;
    return Moment{backwards ? 0 : plan_.duration_ticks, 0.0};  // past its end by rounding
  }

 private:
  const Plan& plan_;
  uint32_t longest_ = 0;
};

// A segment this short whose acceleration begins with a step is a step of the velocity in its middle: its acceleration
// would be subtracted again at once.
constexpr double kStepTicks = 1.0 / 1024.0;

// Where the acceleration is continuous its two figures differ by rounding, which must not become a step.
double step_between(double before, double after) {
  const double step = after - before;
  return math::magnitude(step) <= 1e-9 * math::magnitude(before + after) ? 0.0 : step;
}

// `acceleration` and `jerk`: of the start, counts/tick^n.
void add_segments(Track& track, const Plan& plan, double acceleration, double jerk) {
  const Times times(plan);
  for (uint32_t i = 0; i <= plan.segment_count; ++i) {
    const bool ends = i == plan.segment_count;
    const Segment segment = ends ? Segment{0.0, 0.0, 0.0} : plan.segments[i];
    const double ticks = segment.duration_ticks;
    double step = ends && jerk != 0.0 ? 0.0 : step_between(acceleration, segment.acceleration);
    double jump = 0.0;
    double change = segment.jerk - jerk;
    Moment moment = times.at(i);
    if (ticks < kStepTicks && segment.jerk == 0.0 && segment.acceleration != 0.0 && step != 0.0) {
      jump = segment.acceleration * ticks;
      moment = after(moment, ticks / 2.0);
      step = 0.0;
      change = 0.0;
    } else {
      acceleration = segment.acceleration + segment.jerk * ticks;
      jerk = segment.jerk;
    }
    add_change(track, moment, jump, step, change);
  }
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
  const Wide times[3] = {Wide{ticks, 0}, pairs(ticks), triples(ticks)};
  Wide* d = state.difference;
  for (int to = 0; to < 3; ++to) {
    for (int by = 0; to + by < 3; ++by) add_product(d[to], times[by], d[to + by + 1]);
  }
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

double determinant(const double (&row)[3][3]) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double* b = row[(i + 1) % 3];
    const double* c = row[(i + 2) % 3];
    sum += row[i][0] * (b[1] * c[2] - c[1] * b[2]);
  }
  return sum;
}

// Three constant third differences, one over each third of the move, that take out what is missing at its end.
[[gnu::noinline]] void correct_end(Track& track) {
  constexpr uint32_t kShortest = 12;  // below, what is missing is under an LSB or under 1e-13 of the limits
  const uint32_t n = track.duration_ticks;
  if (n < kShortest) return;
  const Differences end = end_of(track);
  const uint32_t begin[3] = {0, n / 3, n - n / 3};
  double missing[3];
  double effect[3][3];  // of a third difference of 1 from begin[i] on: on position, velocity, acceleration at the end
  for (int i = 0; i < 3; ++i) {
    missing[i] = to_counts(track.end.difference[i] - end.difference[i]);
    const double k = n - begin[i];
    effect[i][2] = k;
    effect[i][1] = k * (k - 1.0) / 2.0;
    effect[i][0] = effect[i][1] * (k - 2.0) / 3.0;
  }
  const double whole = determinant(effect);
  for (int i = 0; i < 3; ++i) {  // Cramer's rule
    swap(effect[i], missing);
    add(at(track, begin[i]).difference[3], determinant(effect) / whole);
    swap(effect[i], missing);
  }
}

double acceleration_of(const Differences& state) { return to_counts(state.difference[2] - state.difference[3]); }

void make_switches(const Plan& plan, const Differences& start, bool in_motion, Track& out) {
  out.start = start;
  out.end = start;
  out.duration_ticks = plan.duration_ticks;
  out.switch_count = 0;
  out.part_count = 0;
  if (plan.duration_ticks == 0) return;
  if (in_motion) {
    add_segments(out, plan, acceleration_of(start), to_counts(start.difference[3]));
  } else {
    add_segments(out, plan, 0.0, 0.0);
  }
}

// From `start` at the plan's own velocity.
void make_switches(const Plan& plan, Signal start, Track& out) {
  Differences moving = standing(start);
  moving.difference[1] = wide(plan.start_velocity);
  make_switches(plan, moving, false, out);
}

void end_at(Signal target, Track& track) {
  track.end = standing(target);
  if (track.duration_ticks != 0) correct_end(track);
}

}  // namespace

StartMotion motion_of(const Differences& state, double tick_s) {
  const double jerk = to_counts(state.difference[3]);
  const double velocity = to_counts(state.difference[1]) - to_counts(state.difference[2]) / 2.0 + jerk / 3.0;
  return StartMotion{velocity / tick_s, acceleration_of(state) / (tick_s * tick_s)};
}

void Track::make(const Plan& plan, Signal start, Signal target, Track& out) {
  if (plan.piece_count != 0) {
    out.start = standing(start);
    out.end = standing(target);
    out.duration_ticks = plan.duration_ticks;
    out.switch_count = 0;
    out.part_count = make_curve(plan, start, target, out.parts);
    return;
  }
  make_switches(plan, start, out);
  end_at(target, out);
}

void Track::make_from(const Plan& plan, const Differences& start, Signal target, Track& out) {
  make_switches(plan, start, true, out);
  end_at(target, out);
}

void Track::make_cruise(const Plan& plan, const Differences& start, double velocity, Track& out) {
  make_switches(plan, start, true, out);
  const Differences end = end_of(out);
  if (velocity == 0.0) return end_at(signal_of(end), out);
  out.end = Differences{{end.difference[0], wide(velocity)}};
}

void Track::make_uncorrected(const Plan& plan, Signal start, Track& out) {
  make_switches(plan, start, out);
  out.end = standing(static_cast<Signal>(end_of(out).difference[0].high));
}

Differences Track::differences_at(uint64_t tick, uint32_t& next_switch) const {
  if (tick < duration_ticks && is_curve()) {
    next_switch = 0;
    return differences_on(parts, part_count, static_cast<uint32_t>(tick));
  }
  if (tick < duration_ticks) return added_up(*this, static_cast<uint32_t>(tick), next_switch);
  next_switch = switch_count;
  Differences state = end;
  add_product(state.difference[0], Wide{tick - duration_ticks, 0}, end.difference[1]);
  return state;
}

}  // namespace stillpoint

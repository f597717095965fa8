// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/linear.hpp"
#include "shaper/shaping/continuation.hpp"
#include "shaper/shaping/peak.hpp"
#include "shaper/shaping/prototype.hpp"
#include "shaper/shaping/zv.hpp"

namespace stillpoint {

namespace {

constexpr size_t kMaxHumps = 3;
constexpr size_t kMaxUnknowns = 3 * kMaxHumps + 4;
using System = LinearSystem<kMaxUnknowns>;

// Unknowns in this order: amplitudes, times after the first, ratios.
struct Unknowns {
  uint32_t humps;
  Impulse impulses[kMaxHumps + 2];
  double ratio[kMaxHumps + 1];

  uint32_t count() const { return humps + 2; }
  uint32_t zeros() const { return humps + 1; }
  uint32_t size() const { return 3 * humps + 4; }
  uint32_t time_at(uint32_t i) const { return count() + i - 1; }
  uint32_t ratio_at(uint32_t k) const { return 2 * count() - 1 + k; }
  void move(const double* change, double part) {
    for (uint32_t i = 0; i < count(); ++i) impulses[i].amplitude += part * change[i];
    for (uint32_t i = 1; i < count(); ++i) impulses[i].time += part * change[time_at(i)];
    for (uint32_t k = 0; k < zeros(); ++k) ratio[k] += part * change[ratio_at(k)];
  }
  bool in_order() const {
    for (uint32_t i = 1; i < count(); ++i) {
      if (!(impulses[i].time > impulses[i - 1].time)) return false;
    }
    for (uint32_t k = 1; k < zeros(); ++k) {
      if (!(ratio[k] > ratio[k - 1])) return false;
    }
    return ratio[0] > 0.0;
  }
};

// cos(pi x) at the zeros in (0, 1) of the undamped shaper, lowest first; x and 2 - x are zeros.
struct Undamped {
  double amplitude[kMaxHumps + 2];
  double cosine[2];
};

// Singhose 1996, as in the reference; V = |sum of the amplitudes times cos((i - middle) pi x)|.
Undamped undamped(uint32_t humps, double v) {
  if (humps == 1) {
    const double a = 0.25 * (1.0 + v);
    return {{a, 0.5 * (1.0 - v), a}, {-0.25 * (1.0 - v) / a, 0.0}};
  }
  if (humps == 2) {
    const double x = math::cbrt(v * v * (math::sqrt(1.0 - v * v) + 1.0));
    const double a = (3.0 * x * x + 2.0 * x + 3.0 * v * v) / (16.0 * x);
    const double b = 0.5 - a;
    // a (4 c^3 - 3 c) + b c with c = cos(pi x / 2), and cos(pi x) = 2 c^2 - 1
    return {{a, b, b, a}, {(3.0 * a - b) / (2.0 * a) - 1.0, 0.0}};
  }
  const double a = (1.0 + 3.0 * v + 2.0 * math::sqrt(2.0 * v * (v + 1.0))) / 16.0;
  const double b = 0.25 * (1.0 - v);
  const double c = 1.0 - 2.0 * (a + b);
  // 4 a c^2 + 2 b c + (c0 - 2 a) = 0
  const double root = math::sqrt(b * b - 4.0 * a * (c - 2.0 * a));
  return {{a, b, c, b, a}, {(-b + root) / (4.0 * a), (-b - root) / (4.0 * a)}};
}

Unknowns undamped_start(uint32_t humps, double v) {
  const Undamped closed = undamped(humps, v);
  Unknowns at{humps, {}, {}};
  for (uint32_t i = 0; i < at.count(); ++i) at.impulses[i] = Impulse{0.5 * i, closed.amplitude[i]};
  for (uint32_t k = 0; k < 2 && 2 * k < at.zeros(); ++k) {
    const double c = closed.cosine[k];
    const double x = 2 * k + 1 == at.zeros() ? 1.0 : math::atan2(math::sqrt(1.0 - c * c), c) / math::kPi;
    at.ratio[k] = x;
    at.ratio[at.zeros() - 1 - k] = 2.0 - x;
  }
  return at;
}

Complex term_of(const Unknowns& at, uint32_t i, const Complex& unit, double x, double end) {
  const Impulse& impulse = at.impulses[i];
  const double angle = unit.im * x * impulse.time;
  return math::exp(unit.re * x * (impulse.time - end)) * Complex{math::cos(angle), math::sin(angle)};
}

// sum A_i exp(lambda t_i) = 0 at zero k. (The factor exp(-zeta w t_n) that keeps the numbers small is a constant here:
// its own derivative multiplies what is to be zero.)
void zero_rows(const Unknowns& at, uint32_t k, const Complex& unit, System& system, uint32_t row) {
  const double x = at.ratio[k];
  Complex value{};
  Complex slope{};
  for (uint32_t i = 0; i < at.count(); ++i) {
    const Impulse& impulse = at.impulses[i];
    const Complex term = term_of(at, i, unit, x, at.impulses[at.count() - 1].time);
    const Complex sized = impulse.amplitude * term;
    value += sized;
    slope += impulse.time * (unit * sized);
    system.row[row][i] = term.re;
    system.row[row + 1][i] = term.im;
    if (i == 0) continue;
    const Complex after_time = x * (unit * sized);
    system.row[row][at.time_at(i)] = after_time.re;
    system.row[row + 1][at.time_at(i)] = after_time.im;
  }
  system.row[row][at.ratio_at(k)] = slope.re;
  system.row[row + 1][at.ratio_at(k)] = slope.im;
  system.right(row) = -value.re;
  system.right(row + 1) = -value.im;
}

// ln V = target at x, the top of a hump: x itself need not be differentiated.
void hump_row(const Unknowns& at, double x, double target, const Complex& unit, System& system, uint32_t row) {
  const double end = at.impulses[at.count() - 1].time;
  Complex value{};
  for (uint32_t i = 0; i < at.count(); ++i) value += at.impulses[i].amplitude * term_of(at, i, unit, x, end);
  for (uint32_t i = 0; i < at.count(); ++i) {
    const Complex over = term_of(at, i, unit, x, end) / value;
    system.row[row][i] = over.re;
    if (i > 0) system.row[row][at.time_at(i)] = (at.impulses[i].amplitude * x * (unit * over)).re;
  }
  system.row[row][at.time_at(at.count() - 1)] -= unit.re * x;  // of exp(-zeta w t_n)
  system.right(row) = target - 0.5 * math::log(square_of(value));
}

// d ln V / dx = 0 at x = 1: a hump stands on the mode.
void centre_row(const Unknowns& at, const Complex& unit, System& system, uint32_t row) {
  const double end = at.impulses[at.count() - 1].time;
  Complex value{};
  Complex slope{};
  for (uint32_t i = 0; i < at.count(); ++i) {
    const Complex sized = at.impulses[i].amplitude * term_of(at, i, unit, 1.0, end);
    value += sized;
    slope += at.impulses[i].time * (unit * sized);
  }
  const Complex ratio = slope / value;
  for (uint32_t i = 0; i < at.count(); ++i) {
    const Complex over = term_of(at, i, unit, 1.0, end) / value;
    const double time = at.impulses[i].time;
    system.row[row][i] = (time * (unit * over) - ratio * over).re;
    if (i == 0) continue;
    const Complex sized = at.impulses[i].amplitude * (unit * over);
    system.row[row][at.time_at(i)] = (sized + time * (unit * sized) - ratio * sized).re;
  }
  system.row[row][at.time_at(at.count() - 1)] -= unit.re;
  system.right(row) = unit.re * end - ratio.re;
}

[[gnu::noinline]] Cascade train_of(const Unknowns& at) {
  Cascade train{};
  train.add(at.impulses, at.count());
  return train;
}

void equations(const Unknowns& at, double damping_ratio, double log_tolerance, System& system) {
  const Complex unit = exponent_of(1.0, damping_ratio);
  system.clear(at.size());
  uint32_t row = 0;
  for (uint32_t i = 0; i < at.count(); ++i) {
    system.row[row][i] = 1.0;
    system.right(row) -= at.impulses[i].amplitude;
  }
  system.right(row) += 1.0;
  ++row;
  for (uint32_t k = 0; k < at.zeros(); ++k, row += 2) zero_rows(at, k, unit, system, row);
  const Cascade train = train_of(at);
  for (uint32_t j = 0; j < at.humps; ++j, ++row) {
    const bool middle = 2 * j + 1 == at.humps;
    const double top = middle ? 1.0 : peak_between(train, damping_ratio, at.ratio[j], at.ratio[j + 1]).frequency;
    hump_row(at, top, log_tolerance, unit, system, row);
  }
  if (at.humps % 2 == 1) {
    centre_row(at, unit, system, row);
  } else {
    const uint32_t middle = at.zeros() / 2;
    system.row[row][at.ratio_at(middle)] = 1.0;
    system.right(row) = 1.0 - at.ratio[middle];
  }
}

// Newton, steps halved while they break the order of things.
bool solve(Unknowns& at, double damping_ratio, double tolerance, const Meanwhile& meanwhile) {
  constexpr int kMostSteps = 12;
  constexpr double kClose = 1e-12;
  constexpr double kWide = 0.2;  // a change of more is no longer a correction
  const double log_tolerance = math::log(tolerance);
  for (int i = 0; i < kMostSteps; ++i) {
    meanwhile();
    System system = {};
    equations(at, damping_ratio, log_tolerance, system);
    double change[kMaxUnknowns] = {};
    if (!system.solve(change)) return false;
    double largest = 0.0;
    for (uint32_t k = 0; k < at.size(); ++k)
      largest = math::magnitude(change[k]) > largest ? math::magnitude(change[k]) : largest;
    if (!(largest < kWide)) return false;
    Unknowns next = at;
    next.move(change, 1.0);
    if (!next.in_order()) return false;
    at = next;
    if (largest < kClose) return true;
  }
  return false;
}

// From the undamped shaper of this tolerance up to the damping, in steps that Newton can follow.
bool find_along_damping(Unknowns& at, double damping_ratio, double tolerance, const Meanwhile& meanwhile) {
  at = undamped_start(at.humps, tolerance);
  return follow(at, 0.0, damping_ratio, 0.05, 0.002, [=](Unknowns& trial, double zeta) {
           return solve(trial, zeta, tolerance, meanwhile);
         }) == damping_ratio;
}

// From a small tolerance, for which there is a solution at every damping, up to this one. Returns the last that has
// one.
double find_along_tolerance(Unknowns& at, double damping_ratio, double tolerance, const Meanwhile& meanwhile) {
  constexpr double kStart = 0.01;
  if (tolerance <= kStart || !find_along_damping(at, damping_ratio, kStart, meanwhile)) return 0.0;
  const double reached = follow(at, math::log(kStart), math::log(tolerance), 0.3, 0.001,
                                [damping_ratio, meanwhile](Unknowns& trial, double log_tolerance) {
                                  return solve(trial, damping_ratio, math::exp(log_tolerance), meanwhile);
                                });
  return reached == math::log(tolerance) ? tolerance : math::exp(reached) * (1.0 - 1e-3);
}

}  // namespace

Status make_extra_insensitive(uint32_t humps, double damping_ratio, double tolerance, Prototype& out,
                              const Meanwhile& meanwhile) {
  Unknowns at{humps, {}, {}};
  if (!find_along_damping(at, damping_ratio, tolerance, meanwhile)) {
    const double reached = find_along_tolerance(at, damping_ratio, tolerance, meanwhile);
    if (reached < tolerance) return refuse(Error::kAboveMaximum, Quantity::kTolerance, tolerance, reached);
  }
  out = Prototype{};
  out.is_banded = true;
  out.train = train_of(at);
  for (uint32_t k = 0; k < at.zeros(); ++k) out.zeros[out.zero_count++] = Zero{at.ratio[k], damping_ratio};
  return kOk;
}

}  // namespace stillpoint

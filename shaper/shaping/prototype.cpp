// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/prototype.hpp"

#include "shaper/base/linear.hpp"
#include "shaper/shaping/zv.hpp"

namespace stillpoint {

namespace {

void make_zeros_at_mode(uint32_t count, double damping_ratio, Prototype& out) {
  out = Prototype{};
  out.is_cascade = true;
  const ZvImpulses zv = zv_impulses(1.0, damping_ratio);
  for (uint32_t i = 0; i < count; ++i) {
    out.train.add(zv.impulses, 2);
    out.zeros[out.zero_count++] = Zero{1.0, damping_ratio};
  }
}

[[gnu::noinline]] void make_train(const Impulse* impulses, uint32_t count, double damping_ratio, Prototype& out) {
  out = Prototype{};
  out.train.add(impulses, count);
  out.zeros[out.zero_count++] = Zero{1.0, damping_ratio};
}

void make_three_impulses(double spacing, double damping_ratio, Prototype& out) {
  const double root = damped_ratio(damping_ratio);
  const double k = math::exp(-2.0 * math::kPi * damping_ratio * spacing / root);
  const double cosine = math::cos(2.0 * math::kPi * spacing);
  const double middle = spacing == kMinSpacing ? 0.0 : -2.0 * cosine * k;
  const double sum = 1.0 + middle + k * k;
  const double apart = spacing / root;
  const Impulse impulses[] = {{0.0, 1.0 / sum}, {apart, middle / sum}, {2.0 * apart, k * k / sum}};
  make_train(impulses, 3, damping_ratio, out);
}

// 1 - exp(lambda t2) + exp(lambda t3) = 0, t2 = 1/6 and t3 = 1/3 undamped; from there Newton converges for any damping
// up to kMaxDampingRatio (tested).
void make_unity_magnitude(double damping_ratio, Prototype& out) {
  const Complex unit = exponent_of(1.0, damping_ratio);
  double t2 = 1.0 / 6.0;
  double t3 = 1.0 / 3.0;
  for (int i = 0; i < 8; ++i) {
    const Complex second = math::exp(t2 * unit);
    const Complex third = math::exp(t3 * unit);
    const Complex value = Complex{1.0, 0.0} - second + third;
    const Complex after_t2 = -1.0 * (unit * second);
    const Complex after_t3 = unit * third;
    LinearSystem<2> system{2, {{after_t2.re, after_t3.re, -value.re}, {after_t2.im, after_t3.im, -value.im}}};
    double change[2] = {};
    if (!system.solve(change)) break;
    t2 += change[0];
    t3 += change[1];
  }
  const Impulse impulses[] = {{0.0, 1.0}, {t2, -1.0}, {t3, 1.0}};
  make_train(impulses, 3, damping_ratio, out);
}

void make_custom(const ShaperSpec& spec, Prototype& out) {
  out = Prototype{};
  out.train.parts[out.train.part_count++] = Cascade::Part{0, spec.train->count};
  for (uint32_t i = 0; i < spec.train->count; ++i) {
    const Impulse& impulse = spec.train->impulses[i];
    out.train.impulses[out.train.impulse_count++] = Impulse{impulse.time * spec.mode.frequency_hz, impulse.amplitude};
  }
  out.zeros[out.zero_count++] = Zero{1.0, spec.mode.damping_ratio};
}

}  // namespace

Status make_prototype(const ShaperSpec& spec, Prototype& out, const Meanwhile& meanwhile) {
  const double zeta = spec.mode.damping_ratio;
  const uint32_t humps = humps_of(spec.kind);
  switch (spec.kind) {
    case ShaperKind::kNone: out = Prototype{}; return kOk;
    case ShaperKind::kZv: make_zeros_at_mode(1, zeta, out); return kOk;
    case ShaperKind::kZvd: make_zeros_at_mode(2, zeta, out); return kOk;
    case ShaperKind::kZvdd: make_zeros_at_mode(3, zeta, out); return kOk;
    case ShaperKind::kZvddd: make_zeros_at_mode(4, zeta, out); return kOk;
    case ShaperKind::kMzv: make_three_impulses(spec.spacing, zeta, out); return kOk;
    case ShaperKind::kEi:
    case ShaperKind::kEi2:
    case ShaperKind::kEi3: return make_extra_insensitive(humps, zeta, spec.tolerance, out, meanwhile);
    case ShaperKind::kCv1:
    case ShaperKind::kCv2:
    case ShaperKind::kCv3:
    case ShaperKind::kCv4: return make_convolution(humps, zeta, spec.tolerance, out, meanwhile);
    case ShaperKind::kUmZv: make_unity_magnitude(zeta, out); return kOk;
    case ShaperKind::kCustom: make_custom(spec, out); return kOk;
  }
  return refuse(Error::kAboveMaximum, Quantity::kKind, static_cast<double>(spec.kind), kShaperKinds - 1);
}

}  // namespace stillpoint

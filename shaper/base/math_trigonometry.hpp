// SPDX-License-Identifier: Apache-2.0
// Sine, cosine, arc tangent. Conventions, accuracy and sources are those of math.hpp.
#pragma once

#include "shaper/base/math_bits.hpp"

namespace stillpoint::math {

// Sines and cosines are given up to here, 2.5*10^5 turns; beyond, kNan.
constexpr double kLargestAngle = 1.6e6;

// x - quadrant * pi/2 = head + tail, |head| <= pi/4 and a little.
struct ReducedAngle {
  double head;
  double tail;
  int32_t quadrant;
};

// pi/2 in four parts of 33, 33, 33, 53 bits: with |k| < 2^20, k times each of the first three is exact.
inline constexpr double kHalfPi[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69, 0x1.b839a252049c1p-104};

// Cost 4 + 12 + 0. Method: Cody and Waite's, the second subtraction with its rounding error kept (Knuth's two-sum).
// An argument within 2^-20 of a multiple of pi/2 goes one part further: there the first `sum` is a multiple of 2^-66
// below 2^-20 and so has no rounding error to keep. No double below kLargestAngle is nearer than 2^-61 to a multiple.
constexpr ReducedAngle reduce_angle(double x) {
  const int32_t k = nearest_integer(x * 0x1.45f306dc9c883p-1);
  if (k == 0) return ReducedAngle{x, 0.0, 0};
  double from = x - k * kHalfPi[0];  // exact
  double part = k * kHalfPi[1];
  double sum = from - part;
  double rest = k * kHalfPi[2];
  if (magnitude(sum) < 0x1p-20) {
    from = sum;
    part = rest;
    sum = from - part;
    rest = k * kHalfPi[3];
  }
  const double shadow = sum - from;
  const double error = (from - (sum - shadow)) - (part + shadow);
  const double correction = error - rest;
  const double head = sum + correction;
  return ReducedAngle{head, (sum - head) + correction, k};
}

// (sin(r)/r - 1) / r^2 and (cos(r) - 1 + r^2/2) / r^4 in r^2, |r| <= pi/4, within 2^-57 of sine and 2^-63 of cosine.
inline constexpr double kSin[] = {-0x1.555555555554ap-3, 0x1.111111110f97dp-7,   -0x1.a01a019c252cdp-13,
                                  0x1.71de3581fb4f8p-19, -0x1.ae5e6ac26c449p-26, 0x1.5d939716a2785p-33};
inline constexpr double kCos[] = {0x1.555555555554cp-5,   -0x1.6c16c16c151c2p-10, 0x1.a01a019cb0d7ep-16,
                                  -0x1.27e4f805aa7cep-22, 0x1.1ee9e7495826ap-29,  -0x1.8fab922baee41p-37};

// sin(head + tail) = sin(head) + tail cos(head)
constexpr double sin_reduced(const ReducedAngle& r) {
  const double z = r.head * r.head;
  return r.head + (r.head * z * polynomial(kSin, z) + r.tail * (1.0 - 0.5 * z));
}

// cos(head + tail) = cos(head) - tail sin(head); 1 - z/2 summed with its rounding error kept.
constexpr double cos_reduced(const ReducedAngle& r) {
  const double z = r.head * r.head;
  const double half = 0.5 * z;
  const double sum = 1.0 - half;
  const double lost = (1.0 - sum) - half;
  return sum + (lost + (z * z * polynomial(kCos, z) - r.tail * r.head));
}

// sin and cos of x quarter turns further on
constexpr double sin_of_quadrant(const ReducedAngle& r, int32_t quarters) {
  const int32_t quadrant = (r.quadrant + quarters) & 3;
  const double value = (quadrant & 1) != 0 ? cos_reduced(r) : sin_reduced(r);
  return quadrant >= 2 ? -value : value;
}

// Sine, |x| <= kLargestAngle rad. Error 0.78 ulp, near multiples of pi too. Cost 14 + 23 + 0.
[[gnu::noinline]] constexpr double sin(double x) {
  if (!(magnitude(x) <= kLargestAngle)) return kNan;
  if (magnitude(x) < 0x1p-27) return x;  // and a zero keeps its sign
  return sin_of_quadrant(reduce_angle(x), 0);
}

// Cosine, |x| <= kLargestAngle rad. Error 0.77 ulp, near odd multiples of pi/2 too. Cost 14 + 23 + 0.
[[gnu::noinline]] constexpr double cos(double x) {
  if (!(magnitude(x) <= kLargestAngle)) return kNan;
  return sin_of_quadrant(reduce_angle(x), 1);
}

// (atan(t)/t - 1) / t^2 in t^2, |t| <= 5/16, within 2^-57 of atan.
inline constexpr double kAtan[] = {-0x1.5555555555522p-2, 0x1.999999998a695p-3,  -0x1.2492491aa9675p-3,
                                   0x1.c71c6bdc74dadp-4,  -0x1.745c1ed4ba203p-4, 0x1.3afb633ac2085p-4,
                                   -0x1.0f9ad662a4796p-4, 0x1.c67ad82e70275p-5,  -0x1.1bdb94935e3fep-5};

struct DoubleDouble {
  double head;
  double tail;
};

// Where the arc of a small t is counted from: [0, pi/2 - ., pi - ., pi/2 + .] of [0, atan(1/2), pi/4].
inline constexpr DoubleDouble kArcOrigin[4][3] = {
    {{0.0, 0.0}, {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56}, {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}},
    {{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54},
     {0x1.1b6e192ebbe44p+0, 0x1.b1b466a88828ep-54},
     {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}},
    {{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53},
     {0x1.56c6e7397f5aep+1, 0x1.660b64ece6f4bp-53},
     {0x1.2d97c7f3321d2p+1, 0x1.a79394c9e8a0ap-54}},
    {{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54},
     {0x1.0468a8ace4df6p+1, 0x1.0620bf7406affp-55},
     {0x1.2d97c7f3321d2p+1, 0x1.a79394c9e8a0ap-54}}};

// atan(low / high) = atan(tangent) + atan(0, 1/2 or 1), |tangent| <= 5/16, for 0 <= low <= high, high > 0.
struct ReducedArc {
  double tangent;
  int origin;
};

// Method: atan(u) - atan(c) = atan((u - c) / (1 + u c)), multiplied out so that u - c costs no rounding:
// low - high/2 and low - high are exact where they are used (Sterbenz).
constexpr ReducedArc reduce_arc(double low, double high) {
  // Away from where high + low would overflow and high / 2 lose a bit.
  if (high > 0x1p+1000 || high < 0x1p-900) {
    const double scale = high > 1.0 ? 0x1p-100 : 0x1p+100;
    high *= scale;
    low *= scale;
  }
  if (low < 0.3125 * high) return ReducedArc{low / high, 0};
  if (low < 0.75 * high) return ReducedArc{(low - 0.5 * high) / (high + 0.5 * low), 1};
  return ReducedArc{(low - high) / (high + low), 2};
}

// The angle of the point (x, y), in [-pi, pi]. Zeros and infinities as in C (Annex F): atan2(0, -1) = pi,
// atan2(-0, -1) = -pi, atan2(0, 0) = 0, and so on. Error 1.51 ulp, where y / x is a little above 1/4, 1/8, ...: the
// angle is a binade lower, and the rounding of the quotient counts double. Elsewhere 1.3, and 0.7 for negative x.
// Cost 15 + 13 + 1.
[[gnu::noinline]] constexpr double atan2(double y, double x) {
  if (is_nan(x) || is_nan(y)) return kNan;
  const double up = magnitude(y);
  const double along = magnitude(x);
  const bool steep = up > along;
  const bool backward = (bits_of(x) & kSignMask) != 0;
  double low = steep ? along : up;
  double high = steep ? up : along;
  if (low == kInfinity) low = high = 1.0;
  if (high == 0.0) high = 1.0;

  const ReducedArc arc = reduce_arc(low, high);
  const double t = steep != backward ? -arc.tangent : arc.tangent;
  const double z = t * t;
  const DoubleDouble& origin = kArcOrigin[(steep ? 1 : 0) + (backward ? 2 : 0)][arc.origin];
  const double angle = origin.head + (t + (t * z * polynomial(kAtan, z) + origin.tail));
  return copysign(angle, y);
}

}  // namespace stillpoint::math

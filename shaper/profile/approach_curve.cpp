// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/approach_curve.hpp"

#include "shaper/base/divide.hpp"
#include "shaper/base/math.hpp"
#include "shaper/base/wide.hpp"
#include "shaper/profile/braking.hpp"

namespace stillpoint {

namespace {

constexpr uint32_t kLevelBits = 20;
constexpr int kRootBits = 31;  // of root()

[[gnu::noinline]] int64_t saturated(double value) {
  return value < 4.0e18 ? static_cast<int64_t>(value) : kMotionLimit - 1;
}

bool less(Wide a, Wide b) { return a.high != b.high ? a.high < b.high : a.low < b.low; }

}  // namespace

ApproachCurve ApproachCurve::make(int64_t velocity, int64_t braking, int64_t jerk) {
  ApproachCurve curve{};
  const int64_t margin = braking / 16 > 1 ? braking / 16 : 1;
  const int64_t most = braking - margin;
  const int64_t half = jerk / 2 < most ? jerk / 2 : most;
  // No more levels than the velocity can use: that is where J m^2 / 2 passes four times the largest.
  const double used = math::sqrt(8.0 * static_cast<double>(velocity) / static_cast<double>(half)) + 1.0;
  int64_t levels = (most + half - 1) / half;
  if (static_cast<double>(levels) > used) levels = static_cast<int64_t>(used);
  if (levels > INT64_C(1) << kLevelBits) levels = INT64_C(1) << kLevelBits;
  curve.levels_ = static_cast<uint32_t>(levels);
  curve.jerk_ = most / levels < half ? most / levels : half;
  curve.braking_ = curve.jerk_ * levels;

  const double j = static_cast<double>(curve.jerk_);
  const double b = static_cast<double>(curve.braking_);
  const double m = static_cast<double>(levels - 1);
  const double near_velocity = j * m * (m + 1.0) / 2.0;
  const double near_gap = near_velocity * (m + 2.0) / 3.0;
  // Closing at twice the velocity with twice the acceleration, it would have to begin letting go of that at
  const double v = static_cast<double>(velocity);
  const double let_go =
      2.0 * static_cast<double>(braking) * (static_cast<double>(braking) / static_cast<double>(jerk) + 1.0);
  const double far_velocity = 2.0 * v + (let_go < 4.0 * v ? let_go : 4.0 * v) + 2.0 * b;
  const double far_gap =
      near_gap + ((far_velocity + b) * far_velocity - (near_velocity + b) * near_velocity) / (2.0 * b);
  curve.near_velocity_ = saturated(near_velocity);
  curve.near_gap_ = saturated(near_gap);
  curve.far_gap_ = saturated(far_gap > near_gap ? far_gap : near_gap);
  const double largest = far_velocity > near_velocity ? far_velocity : near_velocity;
  while (math::ldexp(largest + b, -curve.shift_) >= static_cast<double>(INT64_C(1) << kRootBits)) ++curve.shift_;
  return curve;
}

ApproachCurve::Point ApproachCurve::at(int64_t gap) const {
  if (gap < near_gap_) return near_end(gap);
  return while_braking(gap < far_gap_ ? gap : far_gap_);
}

// 6 gap = J m (m + 1) (m + 2) + part; of the next step of the gap, J (m + 1) (m + 2) / 2, part / 6 is a share that the
// velocity has of its step, J (m + 1), and the braking of J.
ApproachCurve::Point ApproachCurve::near_end(int64_t gap) const {
  const Wide six_gaps = multiply(static_cast<uint64_t>(gap), 6);
  const auto j = static_cast<uint64_t>(jerk_);
  uint64_t m = 0;
  Wide below{0, 0};
  for (uint32_t bit = UINT32_C(1) << kLevelBits; bit != 0; bit >>= 1) {
    const uint64_t tried = m + bit;
    if (tried >= levels_) continue;
    const Wide product = multiply(tried * (tried + 1) * (tried + 2), j);
    if (less(six_gaps, product)) continue;
    m = tried;
    below = product;
  }
  const uint64_t step = divide((six_gaps - below).low, 3 * (m + 2));
  const uint64_t velocity = j * (m * (m + 1) / 2) + step;
  const uint64_t braking = j * (m + 1) + divide(step, m + 1);
  return Point{static_cast<int64_t>(velocity), static_cast<int64_t>(braking)};
}

// (velocity + B/2)^2 grows by 2B a gap.
ApproachCurve::Point ApproachCurve::while_braking(int64_t gap) const {
  const int64_t half = braking_ / 2;
  const uint64_t near = static_cast<uint64_t>(near_velocity_ + half) >> shift_;
  const Wide grown = multiply(static_cast<uint64_t>(gap - near_gap_), 2 * static_cast<uint64_t>(braking_));
  const uint64_t velocity = root(near * near + shifted_right(grown, 2 * shift_).low) << shift_;
  return Point{static_cast<int64_t>(velocity) - half, braking_};
}

}  // namespace stillpoint

// SPDX-License-Identifier: Apache-2.0
#include "shaper/shaping/peak.hpp"

namespace stillpoint {

namespace {

constexpr int kSamples = 11;
constexpr int kSamplesOfWide = 60;
constexpr double kWide = 1.6;  // times `low`: only there may three times the lowest zero fall below `high`
constexpr int kMostSteps = 25;

// A point of the hump at the fraction x of its width: ln V, and its slope times both distances.
struct Point {
  double x;
  double value;
  double tilt;
};

struct Hump {
  const Cascade& cascade;
  double damping_ratio;
  double low;
  double span;

  Point at(double x) const {
    const LogResidual here = log_residual(cascade, low + x * span, damping_ratio);
    return {x, here.value, here.slope * x * (1.0 - x) * span};
  }
};

// Between a point that rises and one that falls.
Point top_between(const Hump& hump, Point& left, Point& right) {
  Point best = left.value > right.value ? left : right;
  int kept = 0;
  for (int i = 0; i < kMostSteps; ++i) {
    const Point next = hump.at(left.x + (right.x - left.x) * left.tilt / (left.tilt - right.tilt));
    if (next.value > best.value) best = next;
    const bool rises = next.tilt > 0.0;
    const double moved = rises ? next.x - left.x : right.x - next.x;
    if (rises && kept == 1) right.tilt *= 0.5;
    if (!rises && kept == -1) left.tilt *= 0.5;
    (rises ? left : right) = next;
    kept = rises ? 1 : -1;
    if (math::magnitude(next.tilt) < 1e-8 || moved < 1e-12) break;
  }
  return best;
}

}  // namespace

Peak peak_between(const Cascade& cascade, double damping_ratio, double low, double high) {
  const Hump hump{cascade, damping_ratio, low, high - low};
  Point before{0.0, -1e9, 1.0};
  Point best{0.5, -1e9, 0.0};
  Point left = before;
  Point right{1.0, -1e9, -1.0};
  bool falls_next = false;
  const int samples = high > kWide * low ? kSamplesOfWide : kSamples;
  for (int i = 1; i <= samples; ++i) {
    const Point here = hump.at(static_cast<double>(i) / (samples + 1));
    if (falls_next) right = here;
    falls_next = false;
    if (here.value > best.value) {
      best = here;
      if (here.tilt > 0.0) {
        left = here;
        right = Point{1.0, -1e9, -1.0};
        falls_next = true;
      } else {
        left = before;
        right = here;
      }
    }
    before = here;
  }
  if (left.tilt > 0.0 && right.tilt < 0.0) best = top_between(hump, left, right);
  return Peak{low + best.x * hump.span, best.value};
}

Peak peak_near(const Cascade& cascade, double damping_ratio, double low, double high) {
  // One tenth beyond either end, so that the weights of the distances are not zero there.
  const double margin = 0.1 * (high - low);
  const Hump hump{cascade, damping_ratio, low - margin, 1.2 * (high - low)};
  Point left = hump.at(1.0 / 12.0);
  Point right = hump.at(11.0 / 12.0);
  Point best = left.value > right.value ? left : right;
  if (left.tilt > 0.0 && right.tilt < 0.0) best = top_between(hump, left, right);
  return Peak{hump.low + best.x * hump.span, best.value};
}

double edge_towards(const Cascade& cascade, double damping_ratio, double log_tolerance, double inside, double limit,
                    double step) {
  const auto tolerated = [&](double frequency) {
    return log_residual(cascade, frequency, damping_ratio).value <= log_tolerance;
  };
  const bool up = limit > inside;
  double outside = inside;
  for (;;) {
    outside = up ? outside + step : outside - step;
    if (up ? outside >= limit : outside <= limit) {
      if (tolerated(limit)) return limit;
      outside = limit;
      break;
    }
    if (!tolerated(outside)) break;
    inside = outside;
  }
  for (int i = 0; i < 44; ++i) {
    const double middle = 0.5 * (inside + outside);
    (tolerated(middle) ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace stillpoint

// SPDX-License-Identifier: Apache-2.0
// Where a table's derivatives are largest. Apart from the rest, so that an image without a use for it does not link it.
#include "shaper/base/math.hpp"
#include "shaper/profile/profile_table.hpp"

namespace stillpoint {

namespace {

constexpr size_t kMaxCoefficients = 2 * kMaxTableOrder + 2;

struct Polynomial {
  double c[kMaxCoefficients];
  size_t count;

  double at(double x) const { return math::horner(c, count, x); }
  Polynomial derivative() const {
    Polynomial d{{}, count - 1};
    for (size_t k = 1; k < count; ++k) d.c[k - 1] = static_cast<double>(k) * c[k];
    return d;
  }
};

// 0, zeros in (0, 1) that rise, 1: between neighbours a function is monotone.
struct Points {
  double x[kMaxCoefficients + 1] = {0.0, 1.0};
  size_t count = 2;
};

double zero_between(const Polynomial& p, double low, double high) {
  const bool rises = p.at(high) > 0.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2.0;
    ((p.at(middle) > 0.0) == rises ? high : low) = middle;
  }
  return (low + high) / 2.0;
}

// The zeros of p, `turns` being those of its derivative.
Points zeros_of(const Polynomial& p, const Points& turns) {
  Points zeros;
  zeros.count = 1;
  for (size_t i = 0; i + 1 < turns.count; ++i) {
    if (p.at(turns.x[i]) * p.at(turns.x[i + 1]) < 0.0)
      zeros.x[zeros.count++] = zero_between(p, turns.x[i], turns.x[i + 1]);
  }
  zeros.x[zeros.count++] = 1.0;
  return zeros;
}

struct Range {
  double low = 0.0;
  double high = 0.0;
  double magnitude() const { return high > -low ? high : -low; }
  void include(const Polynomial& p, const Points& points) {
    for (size_t i = 0; i < points.count; ++i) {
      const double value = p.at(points.x[i]);
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
};

// Widens ranges[k], of derivative k + 1.
void include_span(const Polynomial& position, Range (&ranges)[3]) {
  Polynomial derivatives[kMaxCoefficients];
  derivatives[0] = position;
  for (size_t k = 1; k < position.count; ++k) derivatives[k] = derivatives[k - 1].derivative();
  Points zeros;
  for (size_t k = position.count - 1; k >= 1; --k) {
    if (k <= 3) ranges[k - 1].include(derivatives[k], zeros);
    zeros = zeros_of(derivatives[k], zeros);
  }
}

}  // namespace

TablePeaks peaks_of_nodes(const ProfileTable& table) {
  Range ranges[3];
  for (uint32_t span = 0; span < table.spans; ++span) {
    int64_t coefficients[kMaxCoefficients] = {};
    table.polynomial(span, coefficients);
    Polynomial position{{}, table.degree() + 1U};
    for (size_t k = 0; k < position.count; ++k)
      position.c[k] = static_cast<double>(coefficients[k]) / static_cast<double>(kTableOne);
    include_span(position, ranges);
  }
  // Above what the rounding of the doubles may have hidden.
  const double n = table.spans;
  const double margin = 1.0 + 0x1p-44;
  return TablePeaks{ranges[0].magnitude() * n * margin, ranges[1].high * n * n * margin,
                    -ranges[1].low * n * n * margin, ranges[2].magnitude() * n * n * n * margin};
}

}  // namespace stillpoint

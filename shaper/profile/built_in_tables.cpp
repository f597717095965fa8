// SPDX-License-Identifier: Apache-2.0
// The tables that every build has. Their nodes are computed when this file is compiled; their peaks are those of the
// interpolated curve (tests/shaper/profile/test_profile_table.cpp finds them again).
#include "shaper/base/math.hpp"
#include "shaper/profile/profile_table.hpp"

namespace stillpoint {

namespace {

// More than one span, so that a step of the 64-bit time within a span is less than half an LSB of the longest move.
constexpr uint32_t kPolynomialSpans = 4;
constexpr uint32_t kSineSpans = 8;

template <uint32_t kOrder, uint32_t kSpans>
struct Nodes {
  int64_t node[(kSpans + 1) * (kOrder + 1)];
};

// Of a polynomial with whole coefficients: exact, since the knots are at powers of two.
template <uint32_t kOrder>
constexpr Nodes<kOrder, kPolynomialSpans> nodes_of(const int64_t (&c)[2 * kOrder + 2]) {
  Nodes<kOrder, kPolynomialSpans> nodes{};
  constexpr uint32_t kEach = kOrder + 1;
  for (uint32_t knot = 0; knot <= kPolynomialSpans; ++knot) {
    // Taylor coefficients at the knot, by Horner's rule again and again, in units of kPolynomialSpans^-degree.
    int64_t taylor[2 * kOrder + 2] = {};
    int64_t scale = 1;
    for (uint32_t k = 2 * kOrder + 2; k-- > 0;) {
      taylor[k] = c[k] * scale;
      scale *= kPolynomialSpans;
    }
    for (uint32_t i = 0; i < kEach; ++i) {
      for (uint32_t k = 2 * kOrder + 1; k-- > i;) taylor[k] += taylor[k + 1] * knot;
    }
    for (uint32_t k = 0; k < kEach; ++k)
      nodes.node[knot * kEach + k] = taylor[k] * (kTableOne / (scale / kPolynomialSpans));
  }
  return nodes;
}

constexpr int64_t to_node(double value) {
  const double scaled = value * static_cast<double>(kTableOne);
  return static_cast<int64_t>(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
}

// x - sin(pi x) / pi; at the ends exactly at 0 and 1, with the velocities 0 and 2 and no acceleration.
constexpr Nodes<3, kSineSpans> sine_nodes() {
  Nodes<3, kSineSpans> nodes{};
  constexpr double kStep = 1.0 / kSineSpans;
  for (uint32_t knot = 0; knot <= kSineSpans; ++knot) {
    const bool inner = knot != 0 && knot != kSineSpans;
    const double angle = math::kPi * knot * kStep;
    const double sine = inner ? math::sin(angle) : 0.0;
    const double cosine = knot == kSineSpans ? -1.0 : math::cos(angle);
    int64_t* node = nodes.node + static_cast<ptrdiff_t>(knot) * 4;
    node[0] = to_node(knot * kStep - sine / math::kPi);
    node[1] = to_node((1.0 - cosine) * kStep);
    node[2] = to_node(math::kPi * sine * kStep * kStep / 2.0);
    node[3] = to_node(math::kPi * math::kPi * cosine * kStep * kStep * kStep / 6.0);
  }
  return nodes;
}

constexpr int64_t kQuintic[] = {0, 0, 0, 10, -15, 6};
constexpr int64_t kSeptic[] = {0, 0, 0, 0, 35, -84, 70, -20};
constexpr auto kQuinticNodes = nodes_of<2>(kQuintic);
constexpr auto kSepticNodes = nodes_of<3>(kSeptic);
constexpr auto kSineNodes = sine_nodes();
static_assert(kQuinticNodes.node[3 * kPolynomialSpans] == kTableOne);
static_assert(kSepticNodes.node[4 * kPolynomialSpans] == kTableOne);
static_assert(kSineNodes.node[4 * kSineSpans] == kTableOne);

}  // namespace

const ProfileTable kQuinticTable = {
    2, kPolynomialSpans, kQuinticNodes.node, {1.875, 5.7735026918962582, 5.7735026918962582, 60.0}};
const ProfileTable kSepticTable = {
    3, kPolynomialSpans, kSepticNodes.node, {2.1875, 7.5131884043992932, 7.5131884043992932, 52.5}};
const ProfileTable kSineRampTable = {
    3, kSineSpans, kSineNodes.node, {2.0, 3.1415926535898473, 0.0, 9.8696044011169519}};

}  // namespace stillpoint

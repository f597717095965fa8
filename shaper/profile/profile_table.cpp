// SPDX-License-Identifier: Apache-2.0
#include "shaper/profile/profile_table.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

double from_node(int64_t node) { return static_cast<double>(node) / static_cast<double>(kTableOne); }

Status check_shape(const ProfileTable& table) {
  Status status = check_count(Quantity::kTable, table.order, 1, kMaxTableOrder);
  if (status.ok()) status = check_count(Quantity::kTable, table.spans, 1, kMaxTableSpans);
  if (status.ok() && table.nodes == nullptr) status = refuse(Error::kNotAvailable, Quantity::kTable);
  return status;
}

// At rest at `position`; from order 2 on without acceleration, whose step would be a jerk without limit.
Status check_end(const ProfileTable& table, const int64_t* knot, int64_t position) {
  for (uint32_t k = 0; k < (table.limits_jerk() ? 3U : 2U); ++k) {
    const int64_t wanted = k == 0 ? position : 0;
    if (knot[k] != wanted)
      return refuse(knot[k] < wanted ? Error::kBelowMinimum : Error::kAboveMaximum, Quantity::kTable,
                    from_node(knot[k]), from_node(wanted));
  }
  return kOk;
}

Status check_peaks(const TablePeaks& peaks) {
  const double values[] = {peaks.velocity, peaks.acceleration, peaks.deceleration, peaks.jerk};
  Status status;
  for (size_t i = 0; i < sizeof values / sizeof values[0] && status.ok(); ++i)
    status = check_positive(Quantity::kTable, values[i]);
  return status;
}

}  // namespace

Status ProfileTable::validate() const {
  Status status = check_shape(*this);
  if (!status.ok()) return status;
  const uint32_t each = order + 1;
  status = check_end(*this, nodes, 0);
  if (status.ok()) status = check_end(*this, nodes + spans * each, kTableOne);
  if (status.ok()) status = check_peaks(peaks);
  if (!status.ok()) return status;
  for (uint32_t i = 0; i < (spans + 1) * each; ++i) {
    if (nodes[i] > kLargestNode || nodes[i] < -kLargestNode) {
      const double largest = from_node(kLargestNode);
      return refuse(nodes[i] > 0 ? Error::kAboveMaximum : Error::kBelowMinimum, Quantity::kTable, from_node(nodes[i]),
                    nodes[i] > 0 ? largest : -largest);
    }
  }
  return kOk;
}

// a(x) + x^n r(x), n = order + 1: a is the first knot's Taylor polynomial, and r makes up at the second knot for what a
// lacks there: r = lack / x^n, and in u = x - 1 a division by x = 1 + u is a running difference.
void ProfileTable::polynomial(uint32_t span, int64_t (&coefficients)[2 * kMaxTableOrder + 2]) const {
  const uint32_t n = order + 1;
  const int64_t* first = nodes + span * n;
  const int64_t* second = first + n;
  int64_t* r = coefficients + n;
  for (uint32_t k = 0; k < n; ++k) coefficients[k] = r[k] = first[k];
  for (uint32_t i = 0; i + 1 < n; ++i) {
    for (uint32_t k = n - 1; k-- > i;) r[k] += r[k + 1];
  }
  for (uint32_t k = 0; k < n; ++k) r[k] = second[k] - r[k];
  for (uint32_t i = 0; i < n; ++i) {
    for (uint32_t k = 1; k < n; ++k) r[k] -= r[k - 1];
  }
  for (uint32_t i = 0; i + 1 < n; ++i) {
    for (uint32_t k = n - 1; k-- > i;) r[k] -= r[k + 1];
  }
}

}  // namespace stillpoint

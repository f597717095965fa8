// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/small_lp.hpp"

#include <float.h>

namespace stillpoint {

namespace {

constexpr int kArtificial = -1;
constexpr double kNothing = 1e-11;  // rows and costs are of the order of one

}  // namespace

void SmallLp::set(size_t variable, double cost, double upper) {
  price_[variable] = cost;
  upper_[variable] = upper;
}

void SmallLp::add_row(const double* row, double right, bool equality) {
  if (rows_ == kMaxRows) return;
  const size_t slack = variables_ + rows_;
  const double sign = right < 0.0 ? -1.0 : 1.0;
  double* entries = tableau_[rows_];
  for (size_t i = 0; i < variables_; ++i) entries[i] = sign * row[i];
  // An equality's slack can only be zero.
  entries[slack] = equality ? 0.0 : sign;
  upper_[slack] = equality ? 0.0 : DBL_MAX;
  right_[rows_] = sign * right;
  basic_[rows_] = !equality && sign > 0.0 ? static_cast<int>(slack) : kArtificial;
  ++rows_;
}

// The steepest; after many steps the first, which cannot go round in circles (Bland).
int SmallLp::entering(bool first) const {
  int best = -1;
  double steepest = -kNothing;
  for (size_t j = 0; j < variables_ + rows_; ++j) {
    if (price_[j] >= steepest || upper_[j] <= 0.0) continue;
    best = static_cast<int>(j);
    if (first) break;
    steepest = price_[j];
  }
  return best;
}

// The nonbasic column changes ends: what it was at is the new zero.
void SmallLp::flip_nonbasic(size_t column) {
  for (size_t i = 0; i < rows_; ++i) {
    right_[i] -= tableau_[i][column] * upper_[column];
    tableau_[i][column] = -tableau_[i][column];
  }
  price_[column] = -price_[column];
  flipped_[column] = !flipped_[column];
}

void SmallLp::flip_basic(size_t row) {
  const size_t column = static_cast<size_t>(basic_[row]);
  for (size_t j = 0; j < variables_ + rows_; ++j) tableau_[row][j] = -tableau_[row][j];
  tableau_[row][column] = 1.0;
  right_[row] = upper_[column] - right_[row];
  flipped_[column] = !flipped_[column];
}

void SmallLp::pivot(size_t row, size_t column) {
  const size_t columns = variables_ + rows_;
  const double per = 1.0 / tableau_[row][column];
  for (size_t j = 0; j < columns; ++j) tableau_[row][j] *= per;
  right_[row] *= per;
  for (size_t i = 0; i < rows_; ++i) {
    const double times = tableau_[i][column];
    if (i == row || times == 0.0) continue;
    for (size_t j = 0; j < columns; ++j) tableau_[i][j] -= times * tableau_[row][j];
    tableau_[i][column] = 0.0;
    right_[i] -= times * right_[row];
    if (right_[i] < 0.0) right_[i] = 0.0;
  }
  const double times = price_[column];
  for (size_t j = 0; j < columns; ++j) price_[j] -= times * tableau_[row][j];
  price_[column] = 0.0;
  basic_[row] = static_cast<int>(column);
}

bool SmallLp::step(bool first) {
  const int entry = entering(first);
  if (entry < 0) return false;
  const size_t column = static_cast<size_t>(entry);
  double least = upper_[column];
  size_t leaves = rows_;
  bool to_upper = false;
  for (size_t i = 0; i < rows_; ++i) {
    const double rate = tableau_[i][column];
    const bool falls = rate > kNothing;
    const bool bounded = basic_[i] != kArtificial && upper_[basic_[i]] != DBL_MAX;
    if (!falls && !(rate < -kNothing && bounded)) continue;
    const double room = falls ? right_[i] / rate : (upper_[basic_[i]] - right_[i]) / -rate;
    if (room >= least) continue;
    least = room;
    leaves = i;
    to_upper = !falls;
  }
  if (leaves == rows_) {
    if (least == DBL_MAX) return false;
    flip_nonbasic(column);
    return true;
  }
  if (to_upper) flip_basic(leaves);
  pivot(leaves, column);
  return true;
}

bool SmallLp::solve(double* x) {
  for (size_t i = 0; i < rows_; ++i) {
    if (basic_[i] != kArtificial) continue;
    for (size_t j = 0; j < variables_ + rows_; ++j) price_[j] -= penalty_ * tableau_[i][j];
  }
  int steps = 0;
  while (steps < kMaxSteps && step(steps > kMaxSteps / 2)) ++steps;
  for (size_t j = 0; j < variables_; ++j) x[j] = 0.0;
  for (size_t i = 0; i < rows_; ++i) {
    if (basic_[i] >= 0 && static_cast<size_t>(basic_[i]) < variables_) x[basic_[i]] = right_[i];
  }
  for (size_t j = 0; j < variables_; ++j) {
    if (flipped_[j]) x[j] = upper_[j] - x[j];
  }
  return steps < kMaxSteps;
}

}  // namespace stillpoint

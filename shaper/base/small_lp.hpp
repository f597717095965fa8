// SPDX-License-Identifier: Apache-2.0
// A small linear programme, solved in memory of its own. Background; doubles.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace stillpoint {

// Least cost x with row x = right or row x <= right, 0 <= x <= upper. A row that cannot be kept is broken at the price
// of `penalty` a unit, so there always is an answer. Primal simplex with bounds, on a dense tableau.
class SmallLp {
 public:
  static constexpr size_t kMaxVariables = 21;
  static constexpr size_t kMaxRows = 26;

  SmallLp(size_t variables, double penalty) : variables_(variables), penalty_(penalty) {}

  void set(size_t variable, double cost, double upper);
  // `row` holds a coefficient for each variable. Calls beyond kMaxRows do nothing.
  void add_row(const double* row, double right, bool equality);

  // Once. Into `x`. False if the simplex did not come to its end in its steps: x then keeps the bounds, but may cost
  // more.
  // Cost: at most kMaxSteps times rows x (variables + rows) multiplications.
  bool solve(double* x);

  static constexpr int kMaxSteps = 200;

 private:
  // Columns: variables, then a slack a row. A flipped one is measured from its upper bound down; one that is not basic
  // is zero.
  static constexpr size_t kMaxColumns = kMaxVariables + kMaxRows;

  int entering(bool first) const;
  bool step(bool first);
  void pivot(size_t row, size_t column);
  void flip_nonbasic(size_t column);
  void flip_basic(size_t row);

  size_t variables_;
  double penalty_;
  size_t rows_ = 0;
  double upper_[kMaxColumns] = {};
  bool flipped_[kMaxColumns] = {};
  double price_[kMaxColumns] = {};
  double tableau_[kMaxRows][kMaxColumns] = {};
  double right_[kMaxRows] = {};
  int basic_[kMaxRows] = {};  // the column, or -1: what the row lacks, at the price of the penalty
};

}  // namespace stillpoint

// SPDX-License-Identifier: Apache-2.0
// Least squares for more rows than memory holds.
#pragma once

#include <stddef.h>

#include "shaper/base/math.hpp"

namespace stillpoint {

// The triangle R of A = Q R for a matrix A of up to kColumns columns, whose rows arrive in blocks of up to kRows. With
// the right-hand side as the last column, R holds all that least squares needs; its last diagonal is the root of the
// residual's sum of squares. Orthogonal from end to end, so the condition of A is not squared as by normal equations.
// Cost: 2 columns^2 multiplications and additions a row. Background.
// Method: Householder reflections of R and the block below it (Golub and Van Loan, Matrix Computations, 4th ed., 5.2
// and 6.5.3).
template <size_t kColumns, size_t kRows>
struct Triangle {
  size_t columns;
  size_t filled;
  double row[kColumns][kColumns];
  double block[kColumns][kRows];  // a column's values lie together

  void begin(size_t of_columns) {
    columns = of_columns;
    filled = 0;
    for (size_t i = 0; i < columns; ++i) {
      for (size_t k = 0; k < columns; ++k) row[i][k] = 0.0;
    }
  }

  double& next(size_t column) { return block[column][filled]; }

  // The row written by next() is complete.
  void push() {
    if (++filled == kRows) absorb();
  }

  // What is left of a block. After this, row[][] is R.
  void absorb() {
    for (size_t j = 0; j < columns; ++j) reflect(j);
    filled = 0;
  }

  // row i of R's inverse, of its first `size` rows and columns: from column i on. False where R is singular.
  [[nodiscard]] bool inverse_row(size_t i, size_t size, double* inverse) const {
    for (size_t k = i; k < size; ++k) {
      double sum = k == i ? 1.0 : 0.0;
      for (size_t m = i; m < k; ++m) sum -= inverse[m] * row[m][k];
      if (row[k][k] == 0.0) return false;
      inverse[k] = sum / row[k][k];
    }
    return true;
  }

  // The least-squares solution for the first `size` columns alone; a column that holds nothing gets 0.
  void solve(size_t size, double* solution) const {
    for (size_t i = size; i-- > 0;) {
      double sum = row[i][columns - 1];
      for (size_t k = i + 1; k < size; ++k) sum -= row[i][k] * solution[k];
      solution[i] = row[i][i] == 0.0 ? 0.0 : sum / row[i][i];
    }
  }

 private:
  void reflect(size_t j) {
    double below = 0.0;
    for (size_t i = 0; i < filled; ++i) below += block[j][i] * block[j][i];
    if (below == 0.0) return;
    const double length = math::sqrt(row[j][j] * row[j][j] + below);
    const double diagonal = row[j][j] > 0.0 ? -length : length;
    const double head = row[j][j] - diagonal;
    const double scale = 1.0 / (length * (length + math::magnitude(row[j][j])));
    row[j][j] = diagonal;
    for (size_t k = j + 1; k < columns; ++k) {
      double product = head * row[j][k];
      for (size_t i = 0; i < filled; ++i) product += block[j][i] * block[k][i];
      product *= scale;
      row[j][k] -= product * head;
      for (size_t i = 0; i < filled; ++i) block[k][i] -= product * block[j][i];
    }
  }
};

}  // namespace stillpoint

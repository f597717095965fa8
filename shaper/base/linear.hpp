// SPDX-License-Identifier: Apache-2.0
// Small dense systems of linear equations. Background.
#pragma once

#include <stddef.h>

namespace stillpoint {

// Solves `size` equations in `rows`, which lie `stride` values apart: coefficients first, the right-hand side last.
//
// Gauss with the largest pivot of each column, rows scaled to one first. False, with `solution` untouched, where a
// pivot falls below 1e-13 of its row: singular for all that doubles can tell. Destroys the rows. Cost: size^3 / 3
// multiplications and additions.
[[nodiscard]] bool solve_rows(double* rows, size_t stride, size_t size, double* solution);

// Up to kCapacity equations in as many unknowns; a row is kCapacity coefficients and the right-hand side.
template <size_t kCapacity>
struct LinearSystem {
  size_t size;
  double row[kCapacity][kCapacity + 1];

  void clear(size_t equations) {
    size = equations;
    for (size_t i = 0; i < equations; ++i) {
      for (size_t k = 0; k <= kCapacity; ++k) row[i][k] = 0.0;
    }
  }
  double& right(size_t i) { return row[i][kCapacity]; }
  [[nodiscard]] bool solve(double* solution) { return solve_rows(row[0], kCapacity + 1, size, solution); }
};

}  // namespace stillpoint

// SPDX-License-Identifier: Apache-2.0
// Small dense systems of linear equations. Background.
#pragma once

#include <stddef.h>

#include "shaper/base/math.hpp"

namespace stillpoint {

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

  // Gauss with the largest pivot of each column, rows scaled to one first. False, with `solution` untouched, where a
  // pivot falls below 1e-13 of its row: singular for all that doubles can tell. Destroys the rows. Cost: size^3 / 3
  // multiplications and additions.
  [[nodiscard]] bool solve(double* solution) {
    if (!scale()) return false;
    for (size_t column = 0; column < size; ++column) {
      size_t best = column;
      for (size_t i = column + 1; i < size; ++i) {
        if (math::abs(row[i][column]) > math::abs(row[best][column])) best = i;
      }
      if (!(math::abs(row[best][column]) > 1e-13)) return false;
      swap(best, column);
      for (size_t i = column + 1; i < size; ++i) eliminate(i, column);
    }
    for (size_t i = size; i-- > 0;) {
      double sum = right(i);
      for (size_t k = i + 1; k < size; ++k) sum -= row[i][k] * solution[k];
      solution[i] = sum / row[i][i];
    }
    return true;
  }

 private:
  [[nodiscard]] bool scale() {
    for (size_t i = 0; i < size; ++i) {
      double largest = 0.0;
      for (size_t k = 0; k < size; ++k) largest = math::abs(row[i][k]) > largest ? math::abs(row[i][k]) : largest;
      if (!(largest > 0.0) || !math::is_finite(largest)) return false;
      for (size_t k = 0; k <= kCapacity; ++k) row[i][k] /= largest;
    }
    return true;
  }

  void swap(size_t a, size_t b) {
    if (a == b) return;
    for (size_t k = 0; k <= kCapacity; ++k) {
      const double kept = row[a][k];
      row[a][k] = row[b][k];
      row[b][k] = kept;
    }
  }

  void eliminate(size_t i, size_t column) {
    const double factor = row[i][column] / row[column][column];
    if (factor == 0.0) return;
    for (size_t k = column; k < size; ++k) row[i][k] -= factor * row[column][k];
    right(i) -= factor * right(column);
  }
};

}  // namespace stillpoint

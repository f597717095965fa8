// SPDX-License-Identifier: Apache-2.0
#include "shaper/base/linear.hpp"

#include "shaper/base/math.hpp"

namespace stillpoint {

namespace {

struct Rows {
  double* first;
  size_t stride;
  size_t size;

  double* operator[](size_t i) const { return first + i * stride; }
  double& right(size_t i) const { return (*this)[i][stride - 1]; }

  bool scale() const {
    for (size_t i = 0; i < size; ++i) {
      double* const row = (*this)[i];
      double largest = 0.0;
      for (size_t k = 0; k < size; ++k) largest = math::magnitude(row[k]) > largest ? math::magnitude(row[k]) : largest;
      if (!(largest > 0.0) || !math::is_finite(largest)) return false;
      for (size_t k = 0; k < stride; ++k) row[k] /= largest;
    }
    return true;
  }

  void swap(size_t a, size_t b) const {
    if (a == b) return;
    for (size_t k = 0; k < stride; ++k) {
      const double kept = (*this)[a][k];
      (*this)[a][k] = (*this)[b][k];
      (*this)[b][k] = kept;
    }
  }

  void eliminate(size_t i, size_t column) const {
    double* const row = (*this)[i];
    const double* const pivot = (*this)[column];
    const double factor = row[column] / pivot[column];
    if (factor == 0.0) return;
    for (size_t k = column; k < size; ++k) row[k] -= factor * pivot[k];
    row[stride - 1] -= factor * pivot[stride - 1];
  }
};

}  // namespace

bool solve_rows(double* rows, size_t stride, size_t size, double* solution) {
  const Rows row{rows, stride, size};
  if (!row.scale()) return false;
  for (size_t column = 0; column < size; ++column) {
    size_t best = column;
    for (size_t i = column + 1; i < size; ++i) {
      if (math::magnitude(row[i][column]) > math::magnitude(row[best][column])) best = i;
    }
    if (!(math::magnitude(row[best][column]) > 1e-13)) return false;
    row.swap(best, column);
    for (size_t i = column + 1; i < size; ++i) row.eliminate(i, column);
  }
  for (size_t i = size; i-- > 0;) {
    double sum = row.right(i);
    for (size_t k = i + 1; k < size; ++k) sum -= row[i][k] * solution[k];
    solution[i] = sum / row[i][i];
  }
  return true;
}

}  // namespace stillpoint

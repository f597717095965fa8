// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillpoint {

// Follows the solution of a system that depends on a parameter from `from`, where `at` solves it, up to `to`:
// `solve(at, parameter)` corrects a copy of the last solution and says whether it could. A step that fails is halved.
// Returns the parameter reached, `to` exactly or, where it would take steps below `shortest`, the last that had a
// solution; `at` is its solution. Cost: at most (to - from) (1 / longest + 2 / shortest) calls, near a fold mostly.
template <typename Solution, typename Solve>
double follow(Solution& at, double from, double to, double longest, double shortest, const Solve& solve) {
  double step = longest;
  while (from < to) {
    const double next = to - from < 1.001 * step ? to : from + step;
    Solution trial = at;
    if (solve(trial, next)) {
      at = trial;
      from = next;
      step = 2.0 * step < longest ? 2.0 * step : longest;
    } else {
      step *= 0.5;
      if (step < shortest) break;
    }
  }
  return from;
}

}  // namespace stillpoint

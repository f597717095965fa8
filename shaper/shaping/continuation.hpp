// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillpoint {

// Follows the solution of a system that depends on a parameter from `from`, where `at` solves it, up to `to`:
// `solve(at, parameter)` corrects a copy of the last solution and says whether it could. A step that fails is halved,
// and doubled again only after four that did not: near a fold, where it ends, a longer one would fail once more.
// Returns the parameter reached, `to` exactly or, where it would take steps below `shortest`, the last that had a
// solution; `at` is its solution. Cost: at most 2 (to - from) / shortest calls; to a fold about two for each halving.
template <typename Solution, typename Solve>
double follow(Solution& at, double from, double to, double longest, double shortest, const Solve& solve) {
  constexpr int kRun = 4;
  double step = longest;
  int run = 0;
  while (from < to) {
    const double next = to - from < 1.001 * step ? to : from + step;
    Solution trial = at;
    if (solve(trial, next)) {
      at = trial;
      from = next;
      run = run < kRun ? run + 1 : 1;
      if (run == kRun) step = 2.0 * step < longest ? 2.0 * step : longest;
    } else {
      run = 0;
      step *= 0.5;
      if (step < shortest) break;
    }
  }
  return from;
}

}  // namespace stillpoint

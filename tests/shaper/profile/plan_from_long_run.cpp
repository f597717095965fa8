// SPDX-License-Identifier: Apache-2.0
// As many random moves from random states of motion as asked for; as many from rest to rest against bisection; ten
// times as many plans in counts; a tenth as many compared with a search over all sequences of jerk, with one and with
// two jerks; a fiftieth sampled by a track.  Usage: plan_from_long_run MOVES [SEED]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "tests/shaper/profile/random_moves.hpp"
#include "tests/shaper/profile/random_rest_moves.hpp"

using namespace stillpoint;

namespace {

long count_faults(const char* what, long count, unsigned long long seed, const char* (*fault_of)(testing::Random&)) {
  testing::Random random(seed);
  long faults = 0;
  for (long i = 0; i < count; ++i) {
    const char* fault = fault_of(random);
    if (fault != nullptr && faults++ < 5) std::printf("  case %ld: %s\n", i, fault);
  }
  std::printf("%s: %ld, faults %ld\n", what, count, faults);
  return faults;
}

long compare_all(long count, unsigned long long seed, bool two_jerks) {
  constexpr int kLattices = 20;
  testing::Random random(seed);
  testing::Comparison result;
  for (int i = 0; i < kLattices; ++i) {
    testing::LatticeLimits lattice{static_cast<int>(random.integer(1, 8)), static_cast<int>(random.integer(1, 8)),
                                   static_cast<int>(random.integer(8, 48))};
    if (two_jerks) (i % 2 == 0 ? lattice.jerk : lattice.braking_jerk) = static_cast<int>(random.integer(2, 3));
    compare(random, testing::LatticeOptimum(lattice, 2400), lattice, (count + kLattices - 1) / kLattices, result);
  }
  std::printf("against the search: %ld states, %ld of them braking with the target beyond; %ld in the same ticks; ",
              result.states, result.braking, result.same_ticks);
  std::printf("slower %ld, worst %+.9f ticks\n", result.slower, result.worst_ticks);
  return result.slower;
}

void print_cost(unsigned long long seed) {
  constexpr int kPlans = 20000;
  testing::Random random(seed);
  std::vector<testing::MoveTask> tasks;
  for (int i = 0; i < kPlans; ++i) tasks.push_back(testing::random_task(random, 2.0, 1e-3));
  uint64_t ticks = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (const testing::MoveTask& task : tasks) {
    Plan plan{};
    if (testing::planned_from(task, 1e-3, plan).ok()) ticks += plan.duration_ticks;
  }
  const std::chrono::duration<double, std::nano> passed = std::chrono::steady_clock::now() - begin;
  std::printf("%.0f ns a plan (%.0f ticks in the mean)\n", passed.count() / kPlans,
              static_cast<double>(ticks) / kPlans);
}

}  // namespace

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const auto moves = static_cast<long>(argc > 1 ? std::atof(argv[1]) : 20000.0);
  const auto seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1ULL;
  std::printf("seed %llu\n", seed);
  long faults = count_faults("moves over eight decades of units", moves, seed,
                             [](testing::Random& random) { return testing::fault_of_move(random, 3.0); });
  faults += count_faults("limits up to a million times apart", moves / 5, seed + 1,
                         [](testing::Random& random) { return testing::fault_of_move(random, 12.0); });
  faults += count_faults("changes of velocity", moves / 5, seed + 2,
                         [](testing::Random& random) { return testing::fault_of_velocity_change(random, 4.0); });
  faults += count_faults("starts outside the limits", moves / 5, seed + 6, testing::fault_of_outside_start);
  faults += count_faults("streams in counts", moves / 50, seed + 3, testing::fault_of_stream);
  faults += count_faults("from rest to rest", moves, seed + 8, testing::fault_of_rest_move);
  faults += count_faults("plans in counts", 10 * moves, seed + 9, testing::fault_of_plan_in_counts);
  faults += compare_all(moves / 10, seed + 4, false);
  faults += compare_all(moves / 10, seed + 7, true);
  print_cost(seed + 5);
  return faults == 0 ? 0 : 1;
}

// SPDX-License-Identifier: Apache-2.0
// As many faults, one a run, as asked for.  Usage: fault_campaign RUNS [SEED]
#define DOCTEST_CONFIG_IMPLEMENT
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "tests/firmware/fault_runs.hpp"
#include "tests/firmware/faulty_drive_on_host.hpp"

namespace {

using namespace stillpoint::testing;

long runs = 100;
long moved = 0;
unsigned long long seed = 1;

TEST_HOST(faults_at_any_moment_of_any_move) {
  TEST_INFO("seed", seed);
  Random random(seed);
  for (long run = 0; run < runs; ++run) {
    TEST_INFO("run", run);
    const auto drive = std::make_unique<FaultyDriveOnHost>();
    FaultRun one(*drive, random, kProvoked[static_cast<size_t>(run) % kProvokedCount]);
    one();
    if (one.moved()) ++moved;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) runs = static_cast<long>(std::atof(argv[1]));
  if (argc > 2) seed = std::strtoull(argv[2], nullptr, 10);
  const int result = doctest::Context().run();
  std::printf("seed %llu, %ld runs, %ld of them in motion\n", seed, runs, moved);
  return result;
}

// SPDX-License-Identifier: Apache-2.0
// Random moves behind a shaper for as many ticks as asked for; each must end on its target to the last bit, so nothing
// drifts however long the axis runs.  Usage: long_run TICKS [SEED]
#include <cstdio>
#include <cstdlib>

#include "shaper/axis/axis.hpp"
#include "tests/support/random.hpp"

using namespace stillpoint;

int main(int argc, char** argv) {
  const double budget = argc > 1 ? std::atof(argv[1]) : 1e6;
  const auto seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1ULL;
  testing::Random random(seed);
  static Axis<1024> axis;
  const AxisLimits limits{2e8, 4e10, 4e10, 2e13};
  ShaperDesign design{};
  bool ready = axis.configure(AxisConfig{1e-3, limits, 4e10, 2e13}).ok();
  ready = ready && add_shaper(ShaperKind::kZvd, Mode{11.0, 0.11}, 1e-3, design).ok();
  ready = ready && add_shaper(ShaperKind::kZv, Mode{37.3, 0.02}, 1e-3, design).ok();
  ready = ready && axis.set_shaper(design).ok();
  axis.tick();
  double ticks = 1;
  long moves = 0;
  while (ready && ticks < budget) {
    const auto target = static_cast<int32_t>(random.integer(-1000000000, 1000000000));
    ready = axis.command(Move{target, ProfileKind::kSCurve, limits, 0.0, false}, nullptr).ok();
    do {
      axis.tick();
      ++ticks;
    } while (ready && axis.state().phase != AxisPhase::kAtRest);
    ready = ready && axis.state().setpoint == signal_from_counts(target);
    ++moves;
  }
  std::printf("seed %llu: %ld moves, %.0f ticks: %s\n", seed, moves, ticks,
              ready ? "each ended on its target exactly" : "FAILED: a move did not end on its target");
  return ready ? 0 : 1;
}

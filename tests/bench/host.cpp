// SPDX-License-Identifier: Apache-2.0
// Host nanoseconds a tick. For comparing two builds on one machine; nothing is asserted.
#include <benchmark/benchmark.h>

#include <string>

#include "tests/bench/scenarios.hpp"

namespace {

using namespace stillpoint;
using namespace stillpoint::bench;

void axis_tick(benchmark::State& state, const Scenario& scenario) {
  static Axis<kCapacity> axis;
  ShaperDesign design{};
  const bool ready = axis.configure(kAxis).ok() && design_of(scenario, design).ok() && axis.set_shaper(design).ok();
  static_cast<void>(axis.tick());
  bool forth = axis.state().setpoint == 0;
  bool accepted = ready;
  for (auto _ : state) {
    if (axis.state().phase == AxisPhase::kAtRest) {
      state.PauseTiming();
      accepted = accepted && axis.command(forth ? kMove : kMoveBack, nullptr).ok();
      forth = !forth;
      state.ResumeTiming();
    }
    benchmark::DoNotOptimize(axis.tick());
  }
  if (!accepted) state.SkipWithError("the axis refused");
  while (axis.state().phase != AxisPhase::kAtRest) static_cast<void>(axis.tick());
}

void shaper_tick(benchmark::State& state) {
  static LineSample memory[kCapacity];
  Shaper shaper;
  const auto stages = static_cast<uint32_t>(state.range(0));
  const auto taps = static_cast<uint32_t>(state.range(1));
  if (!shaper.configure(cascade_of(stages, taps), memory, kCapacity, 0).ok()) state.SkipWithError("refused");
  Signal input = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(shaper.tick(input));
    input += 123456789;
  }
}

// One a scenario, by its name.
[[maybe_unused]] const bool kRegistered = [] {
  for (const Scenario& scenario : kScenarios) {
    benchmark::RegisterBenchmark((std::string("axis_tick/") + scenario.name).c_str(), axis_tick, scenario);
  }
  return true;
}();

BENCHMARK(shaper_tick)->ArgNames({"stages", "taps"})->Args({1, 3})->Args({1, 5})->Args({2, 3})->Args({4, 3});

}  // namespace

BENCHMARK_MAIN();

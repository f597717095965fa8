// SPDX-License-Identifier: Apache-2.0
// Host nanoseconds a tick and a plan. For comparing two builds on one machine; nothing is asserted.
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

// In the mean over the same random tasks.
template <typename Planner>
void plan(benchmark::State& state, const Planner& planner) {
  constexpr size_t kTasks = 1024;
  static PlanTask tasks[kTasks];
  testing::Random random(1);
  for (PlanTask& task : tasks) task = random_plan_task(random);
  size_t next = 0;
  bool accepted = true;
  for (auto _ : state) {
    Plan made{};
    accepted = planner(tasks[next++ % kTasks], made).ok() && accepted;
    benchmark::DoNotOptimize(made);
  }
  if (!accepted) state.SkipWithError("refused");
}

void plan_rest_to_rest(benchmark::State& state) {
  plan(state, [](const PlanTask& task, Plan& made) {
    return plan_rest_to_rest(task.distance, task.limits, ProfileKind::kSCurve, kTickS, made);
  });
}

void plan_from_any_state(benchmark::State& state) {
  plan(state, [](const PlanTask& task, Plan& made) {
    return plan_from(task.start, task.distance, task.limits, kTickS, made);
  });
}

BENCHMARK(plan_rest_to_rest);
BENCHMARK(plan_from_any_state);

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

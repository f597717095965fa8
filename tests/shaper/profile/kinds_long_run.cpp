// SPDX-License-Identifier: Apache-2.0
// Random moves in counts of every kind that is not planned in plan.cpp: `kinds_long_run COUNT [SEED]` plans COUNT of
// each kind, and samples every twentieth. Each must take ceil(optimum) ticks, keep its peaks within the limits, arrive,
// and keep the limits on every tick.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "shaper/profile/matched.hpp"
#include "shaper/profile/plan.hpp"
#include "shaper/profile/track.hpp"
#include "tests/support/random.hpp"
#include "tests/support/stream_check.hpp"

namespace {

using namespace stillpoint;
using stillpoint::testing::Random;
using stillpoint::testing::StreamCheck;

constexpr double kTick = 1e-3;
constexpr uint32_t kLongestSampled = 20000;

struct NamedKind {
  const char* name;
  ProfileKind kind;
};
constexpr NamedKind kKinds[] = {{"sin2", ProfileKind::kSin2},
                                {"poly5", ProfileKind::kPoly5},
                                {"poly7", ProfileKind::kPoly7},
                                {"matched", ProfileKind::kMatched}};

struct Task {
  double distance;
  AxisLimits limits;
  ProfileDetail detail;
};

Task random_task(Random& random) {
  Task task{};
  task.distance = std::floor(std::pow(10.0, random.between(0.0, 9.33)));
  const double velocity = task.distance * std::pow(10.0, random.between(-1.5, 3.0));
  const double acceleration = velocity * std::pow(10.0, random.between(-1.0, 3.0));
  const double jerk = acceleration * std::pow(10.0, random.between(-1.0, 4.0));
  const bool even = random.next() % 2 == 0;
  task.limits = AxisLimits{velocity, acceleration, even ? acceleration : acceleration * random.between(0.1, 10.0), jerk,
                           even ? 0.0 : jerk * random.between(0.1, 10.0)};
  task.detail =
      ProfileDetail{nullptr, std::pow(10.0, random.between(-0.3, 2.4)), random.between(0.0, 0.3), plan_matched};
  if (random.next() % 2 == 0) task.distance = -task.distance;
  return task;
}

bool stream_keeps(const Task& task, const Plan& plan, Track& track) {
  const Signal target = signal_from_counts(static_cast<int32_t>(task.distance));
  Track::make(plan, 0, target, track);
  Sampler sampler;
  sampler.begin(track);
  AxisLimits looser = task.limits;
  looser.jerk = task.limits.larger_jerk();
  StreamCheck check(0, task.distance > 0.0, looser, kTick);
  for (uint32_t tick = 0; tick < plan.duration_ticks + 3; ++tick) check.next(sampler.tick());
  return sampler.at_rest() && sampler.position() == target && check.within(0);
}

const char* fault_of(const Task& task, const NamedKind& kind, bool sampled, Track& track) {
  Plan plan{};
  const Status status = plan_rest_to_rest(task.distance, task.limits, kind.kind, kTick, plan, task.detail);
  if (!status.ok()) return status.quantity == Quantity::kDuration ? nullptr : "refused";
  const double least = std::ceil(plan.optimum_ticks * (1.0 - 1e-9));
  if (plan.duration_ticks < least || plan.duration_ticks > least + 1.0) return "ticks";
  const Peaks peaks = peaks_of(plan, kTick);
  constexpr double kSlack = 1.0 + 1e-9;
  if (peaks.velocity > task.limits.velocity * kSlack) return "peak velocity";
  if (peaks.acceleration > std::fmax(task.limits.acceleration, task.limits.deceleration) * kSlack)
    return "peak acceleration";
  if (peaks.jerk > task.limits.larger_jerk() * kSlack) return "peak jerk";
  if (!sampled || plan.duration_ticks > kLongestSampled) return nullptr;
  return stream_keeps(task, plan, track) ? nullptr : "stream";
}

}  // namespace

int main(int argc, char** argv) {
  const double count = argc > 1 ? std::strtod(argv[1], nullptr) : 0.0;
  const uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  if (!(count >= 1.0)) {
    std::fprintf(stderr, "usage: kinds_long_run COUNT [SEED]\n");
    return 2;
  }
  const auto track = std::make_unique<Track>();
  int faults = 0;
  for (const NamedKind& kind : kKinds) {
    Random random(seed);
    for (long i = 0; i < static_cast<long>(count); ++i) {
      const char* fault = fault_of(random_task(random), kind, i % 20 == 0, *track);
      if (fault == nullptr) continue;
      ++faults;
      std::printf("%s, move %ld of seed %llu: %s\n", kind.name, i, static_cast<unsigned long long>(seed), fault);
      if (faults > 20) return 1;
    }
    std::printf("%s: %.0f moves\n", kind.name, count);
  }
  return faults == 0 ? 0 : 1;
}

// SPDX-License-Identifier: Apache-2.0
// As many random moves as asked for, each by the combination of profile and shaper that is still soonest, against the
// S-curve behind a ZV.  Usage: fastest_campaign MOVES [SEED]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "sim/fastest.hpp"
#include "sim/refusal.hpp"
#include "tests/support/random_task.hpp"

using namespace stillpoint;

namespace {

constexpr double kTolerance = 0.05;

struct Tally {
  std::vector<double> gains;  // percent of the ticks of S-curve and ZV
  std::map<std::string, long> won;
  std::map<std::string, std::vector<double>> by_family;  // gain of each family's best
  long slower = 0;
  long broken = 0;
};

// "s-curve + zv, zero delay" of "s-curve + zv:11:0.11, zero delay".
std::string family_of(const sim::FastestCandidate& candidate) {
  std::string name = candidate.name.substr(0, candidate.name.find(':'));
  return candidate.combination.zero_delay ? name + ", zero delay" : name;
}

const sim::FastestCandidate* find(const sim::FastestAnswer& answer, const std::string& family) {
  for (const sim::FastestCandidate& each : answer.candidates) {
    if (family_of(each) == family) return &each;
  }
  return nullptr;
}

void add(Tally& tally, const sim::FastestAnswer& answer) {
  const sim::FastestCandidate& best = answer.candidates.front();
  const sim::FastestCandidate* zv = find(answer, "s-curve + zv");
  if (zv == nullptr || !zv->still_ticks) return;
  if (!best.stream.within_limits || !best.still_ticks) ++tally.broken;
  if (best.still_ticks.value_or(UINT32_MAX) > *zv->still_ticks) ++tally.slower;
  ++tally.won[family_of(best)];
  const auto gain = [zv](const sim::FastestCandidate& one) {
    return 100.0 * (1.0 - static_cast<double>(*one.still_ticks) / *zv->still_ticks);
  };
  if (best.still_ticks) tally.gains.push_back(gain(best));
  for (const sim::FastestCandidate& each : answer.candidates) {
    if (each.still_ticks && each.stream.within_limits) tally.by_family[family_of(each)].push_back(gain(each));
  }
}

double part(std::vector<double> values, double which) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(which * static_cast<double>(values.size() - 1))];
}

void print(const Tally& tally) {
  std::printf("%-28s %6s %6s %14s\n", "combination", "kept", "won", "median gain");
  for (const auto& [family, gains] : tally.by_family) {
    const auto won = tally.won.find(family);
    std::printf("%-28s %6zu %6ld %12.2f %%\n", family.c_str(), gains.size(), won == tally.won.end() ? 0 : won->second,
                part(gains, 0.5));
  }
  std::printf("over the s-curve behind a ZV: median gain %.2f %%, a tenth at most %.2f %%, a tenth at least %.2f %%\n",
              part(tally.gains, 0.5), part(tally.gains, 0.1), part(tally.gains, 0.9));
  std::printf("slower: %ld, limits broken or never still: %ld\n", tally.slower, tally.broken);
}

}  // namespace

int main(int argc, char** argv) {
  const auto moves = static_cast<long>(argc > 1 ? std::atof(argv[1]) : 100.0);
  const auto seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1ULL;
  std::printf("seed %llu\n", seed);
  testing::Random random(seed);
  Tally tally;
  for (long i = 0; i < moves; ++i) {
    const testing::RandomTask drawn = testing::random_task(random);
    sim::MoveTask task{};
    task.distance_counts = drawn.distance_counts;
    task.limits = drawn.limits;
    const sim::FastestQuestion question{task, {{drawn.mode, 1.0}}, {drawn.mode}, kTolerance};
    add(tally, sim::find_fastest(question));
  }
  print(tally);
  const bool all_counted = static_cast<long>(tally.gains.size()) == moves;
  return tally.slower == 0 && tally.broken == 0 && all_counted ? 0 : 1;
}

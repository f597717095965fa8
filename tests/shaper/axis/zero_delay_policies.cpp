// SPDX-License-Identifier: Apache-2.0
// As many random (move, mode, limits) as asked for, each with a wanted duration T of the plain move that leaves 0 to
// 30 % of room: how often each way of keeping it shaped does, and by how much it misses when not.
// Usage: zero_delay_policies MOVES [SEED]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "shaper/axis/axis.hpp"
#include "shaper/axis/raised_plan.hpp"
#include "tests/support/random_task.hpp"
#include "tests/support/stream_check.hpp"

using namespace stillpoint;

namespace {

constexpr double kTick = 1e-3;
constexpr size_t kLine = 4096;
using TestAxis = Axis<kLine>;

struct Row {
  const char* name;
  long met = 0;
  std::vector<double> misses = {};  // percent of T

  void add(double least_ticks, double wanted_ticks) {
    if (least_ticks <= wanted_ticks) {
      ++met;
    } else {
      misses.push_back(100.0 * (least_ticks / wanted_ticks - 1.0));
    }
  }
};

struct Table {
  Row rows[5] = {{"(a) sped up uniformly to T (Li 2017)"},
                 {"(b) planned within the limits"},
                 {"(c) scaled to the most binding limit"},
                 {"(d) planned for raised limits"},
                 {"the axis"}};
  long moves = 0;
  long faults = 0;

  void fault(const char* what) {
    if (faults++ < 5) std::printf("  move %ld: %s\n", moves, what);
  }
};

double part(std::vector<double> values, double which) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(which * static_cast<double>(values.size() - 1))];
}

void print(const char* shaper, const Table& table) {
  std::printf("behind %s, %ld moves\n%-38s %9s %13s %13s %9s\n", shaper, table.moves, "", "meets T", "misses by",
              "a tenth by", "most");
  for (const Row& row : table.rows) {
    std::printf("%-38s %7.1f %% %11.2f %% %11.2f %% %7.2f %%\n", row.name,
                100.0 * static_cast<double>(row.met) / static_cast<double>(table.moves), part(row.misses, 0.5),
                part(row.misses, 0.9), part(row.misses, 1.0));
  }
}

// What the axis emits for a move that it took, checked.
void run(TestAxis& axis, const Move& move, const MoveReport& report, uint32_t stages, Table& table) {
  const Signal start = axis.state().setpoint;
  const Signal target = signal_from_counts(move.target_counts);
  testing::StreamCheck check(start, target >= start, move.limits, kTick);
  for (uint32_t i = 0; i < report.total_ticks; ++i) check.next(axis.tick());
  if (axis.state().setpoint != target) table.fault("not at its target in the ticks reported");
  for (int i = 0; i < 4; ++i) check.next(axis.tick());
  if (!check.within(stages)) table.fault("limits broken");
}

void try_move(testing::Random& random, ShaperKind kind, Table& table) {
  const testing::RandomTask task = testing::random_task(random);
  const double room = random.between(0.0, 0.3);
  ShaperDesign design{};
  Plan plain{};
  if (!add_shaper(kind, task.mode, kTick, design).ok() || task.distance_counts == 0 ||
      !plan_rest_to_rest(task.distance_counts, task.limits, ProfileKind::kSCurve, kTick, plain).ok()) {
    return;
  }
  ++table.moves;
  const auto axis = std::make_unique<TestAxis>();
  AxisConfig config{kTick, {1e12, 1e15, 1e15, 1e18}, 1e9, 1e12};
  if (!axis->configure(config).ok() || !axis->set_shaper(design).ok()) table.fault("no axis");
  axis->tick();
  const double wanted = std::floor(plain.duration_ticks * (1.0 + room));
  const Move move{task.distance_counts, ProfileKind::kSCurve, task.limits, wanted * kTick, true};

  static LineSample memory[kLine];
  Shaper shaper;
  Track track{};
  const Signal target = signal_from_counts(task.distance_counts);
  if (!shaper.configure(design, memory, kLine, 0).ok()) table.fault("no shaper");
  ShapedMoveCheck check(task.limits, true, kTick, shaper, track, 0, target);
  const uint32_t length = design.length_ticks();
  const uint32_t planned = plain.duration_ticks;
  const bool fits = wanted > length;
  const bool at_once = fits && check.broken_at(plain, static_cast<uint32_t>(wanted) - length) == Quantity::kNone;
  Quantity binding = Quantity::kNone;
  const double scaled = check.least_ticks(plain, 0, planned, binding) + length;
  const CheckedPlan soonest = SoonestSearch(check, design, move, plain, kTick).find();
  const double raised = soonest.plan.duration_ticks + length;
  table.rows[0].add(at_once ? wanted : scaled > wanted ? scaled : wanted + 1.0, wanted);
  table.rows[1].add(planned + length, wanted);
  table.rows[2].add(scaled, wanted);
  table.rows[3].add(raised, wanted);

  MoveReport report{};
  const Status status = axis->command(move, &report);
  const double least = status.ok() ? report.total_ticks : std::round(status.accepted / kTick);
  table.rows[4].add(least, wanted);
  const double least_of_all = std::min({scaled, raised, static_cast<double>(planned + length)});
  if (status.ok() != (least_of_all <= wanted))
    table.fault("the axis refuses what a policy meets, or takes what none does");
  if (!status.ok() && least != least_of_all) table.fault("the duration it would accept is not the least");
  if (!status.ok() && status.error != Error::kLimitExceeded) table.fault("refused for another reason");
  Move again = move;
  again.duration_s = least * kTick;
  if (!status.ok() && !axis->command(again, &report).ok()) return table.fault("refuses the duration it named");
  run(*axis, move, report, design.stage_count, table);
}

}  // namespace

int main(int argc, char** argv) {
  const auto moves = static_cast<long>(argc > 1 ? std::atof(argv[1]) : 100.0);
  const auto seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1ULL;
  std::printf("seed %llu\n", seed);
  long faults = 0;
  for (const ShaperKind kind : {ShaperKind::kZv, ShaperKind::kMzv, ShaperKind::kZvd}) {
    testing::Random random(seed);
    Table table;
    for (long i = 0; i < moves; ++i) try_move(random, kind, table);
    print(text(kind), table);
    faults += table.faults;
  }
  std::printf("faults %ld\n", faults);
  return faults == 0 ? 0 : 1;
}

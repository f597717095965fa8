// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/hil_moves.hpp"

#include <fmt/format.h>

#include "sim/cli/json.hpp"
#include "sim/cli/move_output.hpp"
#include "sim/hash.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

std::string hash_text(uint64_t hash) { return fmt::format("{:016x}", hash); }

HilMoves against(const sim::Comparison& host, const MoveJob& job, const std::string& elf) {
  HilMoves moves{};
  moves.job = job;
  {
    Progress progress("plain move on the chip");
    moves.plain = run_on_chip(elf, job.plain, {}, job.arm, progress);
  }
  {
    Progress progress("shaped move on the chip");
    moves.shaped = run_on_chip(elf, job.shaped, job.specs, job.arm, progress);
  }
  moves.plain_hashes = {sim::setpoint_hash(moves.plain.recording.setpoints), sim::setpoint_hash(host.plain.setpoints)};
  moves.shaped_hashes = {sim::setpoint_hash(moves.shaped.recording.setpoints),
                         sim::setpoint_hash(host.shaped.setpoints)};
  moves.comparison = sim::compare(job.plain, moves.plain.recording, job.shaped, moves.shaped.recording, job.arm,
                                  job.design.stage_count, job.settle_band);
  return moves;
}

Json json_of_rounded(const MoveJob& job) {
  const double unit = job.plain.counts_per_unit;
  Json shapers = Json::array();
  for (const sim::SpecifiedShaper& spec : job.specs) shapers.push_back(sim::spec_text(spec));
  return {{"distance_counts", job.plain.distance_counts},
          {"kind", profile_text(job.plain.profile)},
          {"velocity", job.plain.limits.velocity / unit},
          {"acceleration", job.plain.limits.acceleration / unit},
          {"deceleration", job.plain.limits.deceleration / unit},
          {"jerk", job.plain.limits.jerk / unit},
          {"duration_s", job.plain.duration_s},
          {"shaped_duration_s", job.shaped.duration_s},
          {"zero_delay", job.shaped.zero_delay},
          {"shapers", shapers}};
}

}  // namespace

HilMoves run_on_chip_and_host(const MoveJob& job, const std::string& elf) {
  return against(run_on_host(job), job, elf);
}

HilMoves run_on_chip_within_or_least(const MoveJob& job, const std::string& elf) {
  MoveJob allowed = job;
  const sim::Comparison host = run_within_or_least(allowed);
  return against(host, allowed, elf);
}

Json json_of(const HilMoves& moves) {
  Json object = {{"result", moves.same_bits() ? "ok" : "hash_mismatch"}};
  object.update(json_of(moves.comparison));
  object["ticks"] = moves.shaped.recording.setpoints.size() - 1;
  object["setpoint_hash"] = hash_text(moves.shaped_hashes.chip);
  object["host_setpoint_hash"] = hash_text(moves.shaped_hashes.host);
  object["plain_ticks"] = moves.plain.recording.setpoints.size() - 1;
  object["plain_setpoint_hash"] = hash_text(moves.plain_hashes.chip);
  object["plain_host_setpoint_hash"] = hash_text(moves.plain_hashes.host);
  object["locked_ticks"] = moves.plain.locked_ticks + moves.shaped.locked_ticks;
  if (moves.shaped.instructions_per_tick) {
    object["instructions_per_tick"] = *moves.shaped.instructions_per_tick;
    object["most_instructions_per_tick"] = moves.shaped.most_instructions;
    object["late_ticks"] = moves.plain.late_ticks + moves.shaped.late_ticks;
  }
  object["as_in_registers"] = json_of_rounded(moves.job);
  return object;
}

void print_moves(const HilMoves& moves) {
  fmt::print("As the registers hold it:");
  const Json registers = json_of_rounded(moves.job);
  for (const auto& [name, value] : registers.items()) fmt::print(" {} {}", name, value.dump());
  fmt::print("\n\n");
  print_comparison(moves.comparison);
  fmt::print("\n");
  Table table({"setpoints", "ticks", "hash on the chip", "hash on the host", ""});
  const auto row = [&](const char* name, const ChipRun& run, const Hashes& hashes) {
    table.row({name, std::to_string(run.recording.setpoints.size() - 1), hash_text(hashes.chip), hash_text(hashes.host),
               hashes.same() ? "same" : "DIFFERENT"});
  };
  row("plain", moves.plain, moves.plain_hashes);
  row("shaped", moves.shaped, moves.shaped_hashes);
  table.print();
  fmt::print("{} ticks in lock\n", moves.plain.locked_ticks + moves.shaped.locked_ticks);
  if (moves.shaped.instructions_per_tick) {
    fmt::print("instructions a tick: {:.1f}, at most {}; late ticks: {}\n", *moves.shaped.instructions_per_tick,
               moves.shaped.most_instructions, moves.plain.late_ticks + moves.shaped.late_ticks);
  }
}

int exit_code_of(const HilMoves& moves) {
  if (moves.same_bits()) return 0;
  std::fflush(stdout);
  const Hashes& differing = moves.shaped_hashes.same() ? moves.plain_hashes : moves.shaped_hashes;
  fmt::print(stderr, "stillpoint: error: setpoint hash: {}: not the host's, {} is accepted\n",
             hash_text(differing.chip), hash_text(differing.host));
  return 1;
}

}  // namespace stillpoint::cli

// SPDX-License-Identifier: Apache-2.0
// `stillpoint hil`: the firmware in the emulator, on the simulated arm, against the host.
#include <fmt/format.h>

#include <memory>

#include "sim/cli/chip.hpp"
#include "sim/cli/command.hpp"
#include "sim/cli/move_job.hpp"
#include "sim/cli/move_output.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/hash.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

struct Hashes {
  uint64_t chip;
  uint64_t host;
  bool same() const { return chip == host; }
};

struct Result {
  MoveJob job;  // rounded
  ChipRun plain;
  ChipRun shaped;
  sim::Comparison comparison;  // of what the chip emitted
  Hashes plain_hashes;
  Hashes shaped_hashes;
  bool same_bits() const { return plain_hashes.same() && shaped_hashes.same(); }
};

std::string hash_text(uint64_t hash) { return fmt::format("{:016x}", hash); }

Result run_both(const MoveJobOptions& options, const std::string& elf) {
  Result result{};
  result.job = rounded(job_of(options));
  const MoveJob& job = result.job;
  const sim::Comparison host = run_on_host(job);
  {
    Progress progress("plain move on the chip");
    result.plain = run_on_chip(elf, job.plain, {}, job.arm, progress);
  }
  {
    Progress progress("shaped move on the chip");
    result.shaped = run_on_chip(elf, job.shaped, job.specs, job.arm, progress);
  }
  result.plain_hashes = {sim::setpoint_hash(result.plain.recording.setpoints),
                         sim::setpoint_hash(host.plain.setpoints)};
  result.shaped_hashes = {sim::setpoint_hash(result.shaped.recording.setpoints),
                          sim::setpoint_hash(host.shaped.setpoints)};
  result.comparison = sim::compare(job.plain, result.plain.recording, job.shaped, result.shaped.recording, job.arm,
                                   job.design.stage_count, job.settle_band);
  return result;
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

void print_as_json(const Result& result) {
  Json object = {{"result", result.same_bits() ? "ok" : "hash_mismatch"}};
  object.update(json_of(result.comparison));
  object["ticks"] = result.shaped.recording.setpoints.size() - 1;
  object["setpoint_hash"] = hash_text(result.shaped_hashes.chip);
  object["host_setpoint_hash"] = hash_text(result.shaped_hashes.host);
  object["plain_ticks"] = result.plain.recording.setpoints.size() - 1;
  object["plain_setpoint_hash"] = hash_text(result.plain_hashes.chip);
  object["plain_host_setpoint_hash"] = hash_text(result.plain_hashes.host);
  object["locked_ticks"] = result.plain.locked_ticks + result.shaped.locked_ticks;
  if (result.shaped.instructions_per_tick) {
    object["instructions_per_tick"] = *result.shaped.instructions_per_tick;
    object["most_instructions_per_tick"] = result.shaped.most_instructions;
    object["late_ticks"] = result.plain.late_ticks + result.shaped.late_ticks;
  }
  object["as_in_registers"] = json_of_rounded(result.job);
  print_json(object);
}

void print_as_table(const Result& result) {
  fmt::print("As the registers hold it:");
  const Json registers = json_of_rounded(result.job);
  for (const auto& [name, value] : registers.items()) fmt::print(" {} {}", name, value.dump());
  fmt::print("\n\n");
  print_comparison(result.comparison);
  fmt::print("\n");
  Table table({"setpoints", "ticks", "hash on the chip", "hash on the host", ""});
  const auto row = [&](const char* name, const ChipRun& run, const Hashes& hashes) {
    table.row({name, std::to_string(run.recording.setpoints.size() - 1), hash_text(hashes.chip), hash_text(hashes.host),
               hashes.same() ? "same" : "DIFFERENT"});
  };
  row("plain", result.plain, result.plain_hashes);
  row("shaped", result.shaped, result.shaped_hashes);
  table.print();
  fmt::print("{} ticks in lock\n", result.plain.locked_ticks + result.shaped.locked_ticks);
  if (result.shaped.instructions_per_tick) {
    fmt::print("instructions a tick: {:.1f}, at most {}; late ticks: {}\n", *result.shaped.instructions_per_tick,
               result.shaped.most_instructions, result.plain.late_ticks + result.shaped.late_ticks);
  }
}

int run(const MoveJobOptions& options, const std::string& elf, const Output& output) {
  check_output(output);
  if (elf.empty()) throw sim::bad_argument("--elf", "missing", "a firmware image is needed, `--elf FILE` is accepted");
  const Result result = run_both(options, elf);
  if (!output.csv.empty()) write_move_csv(output.csv, "hil", result.job, result.comparison);
  if (!output.plot.empty()) {
    draw(output.plot, picture_of("stillpoint hil: the firmware in the emulator", result.job, result.comparison));
  }
  if (output.json) {
    print_as_json(result);
  } else {
    print_as_table(result);
  }
  if (result.same_bits()) return 0;
  std::fflush(stdout);
  const Hashes& differing = result.shaped_hashes.same() ? result.plain_hashes : result.shaped_hashes;
  fmt::print(stderr, "stillpoint: error: setpoint hash: {}: not the host's, {} is accepted\n",
             hash_text(differing.chip), hash_text(differing.host));
  return 1;
}

}  // namespace

void add_hil(Commands& commands, Output& output) {
  const auto options = std::make_shared<MoveJobOptions>();
  const auto elf = std::make_shared<std::string>();
  CLI::App& app = commands.add("hil", "Runs a move plain and shaped on the firmware in the emulator, and compares.",
                               [options, elf, &output] { return run(*options, *elf, output); });
  add_value(app, "--elf", *elf, "FILE", "the firmware: build/stm32f405/stillpoint.elf");
  add_move_job(app, *options);
  add_output(app, output);
}

}  // namespace stillpoint::cli

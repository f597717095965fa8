// SPDX-License-Identifier: Apache-2.0
// `stillpoint demo`: the arm of Li 2017, plain, shaped, and shaped with zero delay.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "sim/cli/chip.hpp"
#include "sim/cli/command.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/move_job.hpp"
#include "sim/cli/move_output.hpp"
#include "sim/cli/register_values.hpp"
#include "sim/hash.hpp"

namespace stillpoint::cli {
namespace {

struct Shown {
  std::string name;
  std::string where;  // "host" or "chip"
  MoveJob job;
  sim::Comparison comparison;
};

// What is shown of each place: the same three moves.
struct Chosen {
  std::string name;
  MoveJob job;
};

// Li gives no distance; this one rings about as much (reference.md, section 5).
MoveJobOptions paper_move() {
  MoveJobOptions options;
  options.move.distance = "1.7";
  options.move.velocity = "1.2";
  options.move.acceleration = "20";
  options.move.jerk = "600";
  options.move.duration = "1.62";
  options.shaper.specs = {"zv:11:0.11"};
  options.arm = "11:0.11";
  return options;
}

MoveJobOptions zero_delay(const std::string& duration) {
  MoveJobOptions options = paper_move();
  options.zero_delay = true;
  options.shaped_duration = duration;
  return options;
}

std::vector<Chosen> chosen_moves() {
  return {{"zv", rounded(job_of(paper_move()))},
          {"zv, zero delay, 1.62 s", rounded(job_of(zero_delay("1.62")))},
          {"zv, zero delay, 1.60 s", rounded(job_of(zero_delay("1.60")))}};
}

std::vector<Shown> on_host(const std::vector<Chosen>& moves) {
  std::vector<Shown> shown;
  for (const Chosen& move : moves) shown.push_back({move.name, "host", move.job, run_on_host(move.job)});
  return shown;
}

std::vector<Shown> on_chip(const std::vector<Chosen>& moves, const std::string& elf) {
  const auto run = [&elf](const std::string& what, const sim::MoveTask& task, const MoveJob& job, bool shaped) {
    Progress progress("on the chip: " + what);
    return run_on_chip(elf, task, shaped ? job.specs : std::vector<sim::SpecifiedShaper>{}, job.arm, progress)
        .recording;
  };
  const MoveJob& any = moves[0].job;
  const sim::Recording plain = run("plain", any.plain, any, false);
  std::vector<Shown> shown;
  for (const Chosen& move : moves) {
    const MoveJob& job = move.job;
    shown.push_back({move.name, "chip", job,
                     sim::compare(job.plain, plain, job.shaped, run(move.name, job.shaped, job, true), job.arm,
                                  job.design.stage_count, job.settle_band)});
  }
  return shown;
}

// The chip's setpoints are the host's, bit for bit: the moves of the one come before those of the other.
bool same_bits(const std::vector<Shown>& moves) {
  const size_t half = moves.size() / 2;
  for (size_t i = 0; i < half; ++i) {
    const sim::Comparison& host = moves[i].comparison;
    const sim::Comparison& chip = moves[half + i].comparison;
    if (sim::setpoint_hash(host.plain.setpoints) != sim::setpoint_hash(chip.plain.setpoints)) return false;
    if (sim::setpoint_hash(host.shaped.setpoints) != sim::setpoint_hash(chip.shaped.setpoints)) return false;
  }
  return true;
}

void print_as_json(const std::vector<Shown>& moves, std::optional<bool> same) {
  Json list = Json::array();
  for (const Shown& shown : moves) {
    Json object = {{"name", shown.name}, {"where", shown.where}};
    object.update(json_of(shown.comparison));
    list.push_back(object);
  }
  Json object = {{"result", same.value_or(true) ? "ok" : "hash_mismatch"}, {"moves", list}};
  if (same) object["chip_same_as_host"] = *same;
  print_json(object);
}

void print_as_table(const std::vector<Shown>& moves, std::optional<bool> same, const std::string& picture) {
  fmt::print("The arm of Li 2017: 11 Hz, damping ratio 0.11. A move of 1.7 unit in 1.62 s.\n\n");
  Table table = figures_table();
  std::string where;
  for (const Shown& shown : moves) {
    if (shown.where != where) add_figures(table, shown.where + ": plain", shown.comparison.plain_figures, 1.0);
    where = shown.where;
    add_figures(table, shown.where + ": " + shown.name, shown.comparison.shaped_figures,
                shown.comparison.residual_ratio);
  }
  table.print();
  fmt::print("\n");
  if (same) fmt::print("setpoints of chip and host: {}\n", *same ? "the same, bit for bit" : "DIFFERENT");
  fmt::print("picture: {}\n", picture);
}

int run(const std::string& elf, const std::string& plot, const Output& output) {
  check_picture(plot);
  const std::vector<Chosen> chosen = chosen_moves();
  std::vector<Shown> moves = on_host(chosen);
  std::optional<bool> same;
  if (!elf.empty()) {
    const std::vector<Shown> chip = on_chip(chosen, elf);
    moves.insert(moves.end(), chip.begin(), chip.end());
    same = same_bits(moves);
  }
  const Shown& drawn = moves[moves.size() - 2];  // zero delay within the time of the plain move
  draw(plot, picture_of("The arm of Li 2017: plain, and shaped with zero delay within 1.62 s (" + drawn.where + ")",
                        drawn.job, drawn.comparison));
  if (output.json) {
    print_as_json(moves, same);
  } else {
    print_as_table(moves, same, plot);
  }
  if (same.value_or(true)) return 0;
  std::fflush(stdout);
  fmt::print(stderr, "stillpoint: error: setpoints: chip: not those of the host, the same bits are accepted\n");
  return 1;
}

}  // namespace

void add_demo(Commands& commands, Output& output) {
  const auto elf = std::make_shared<std::string>();
  const auto plot = std::make_shared<std::string>("stillpoint-demo.svg");
  CLI::App& app = commands.add("demo", "Shows the whole chain on the arm of Li 2017, with a table and a picture.",
                               [elf, plot, &output] { return run(*elf, *plot, output); });
  add_value(app, "--elf", *elf, "FILE", "show it on the firmware in the emulator too: build/stm32f405/stillpoint.elf");
  add_json(app, output);
  add_value(app, "--plot", *plot, "FILE", "the picture, FILE.svg or FILE.png (default stillpoint-demo.svg)");
}

}  // namespace stillpoint::cli

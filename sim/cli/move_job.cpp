// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/move_job.hpp"

#include "sim/cli/progress.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {

namespace {

void add_arm(CLI::App& app, MoveJobOptions& options) {
  add_value(app, "--shaped-duration", options.shaped_duration, "T",
            "duration of the shaped move with zero delay [s] (default: --duration)");
  add_value(app, "--arm", options.arm, "F:Z[:SHARE],...",
            "the simulated arm: each mode's frequency [Hz], damping ratio and share of the displacement");
  add_value(app, "--settle-band", options.settle_band, "R",
            "settled: tip acceleration below this part of the plain peak after the move (default 0.2)");
}

}  // namespace

void add_move_job(CLI::App& app, MoveJobOptions& options) {
  add_move_options(app, options.move);
  add_shaper(app, options.shaper);
  add_flag(app, "--zero-delay", options.zero_delay,
           "the shaped move ends within --shaped-duration, or --duration, or the least time the limits allow");
  add_arm(app, options);
}

void add_move_job_without_shaper(CLI::App& app, MoveJobOptions& options) {
  add_move_options(app, options.move);
  add_arm(app, options);
}

MoveJob job_without_shaper(const MoveJobOptions& options) {
  MoveJob job{task_of(options.move), {}, {}, {}, {}, 0.0};
  job.shaped = job.plain;
  job.shaped.zero_delay = options.zero_delay;
  if (!options.shaped_duration.empty()) {
    if (!options.zero_delay) {
      throw sim::bad_argument("--shaped-duration", options.shaped_duration,
                              "given alone, it is accepted with --zero-delay");
    }
    job.shaped.duration_s = sim::parse_positive(options.shaped_duration, "--shaped-duration");
  }
  if (options.arm.empty()) {
    throw sim::bad_argument("--arm", "missing", "an arm is needed, e.g. `--arm 11:0.11` is accepted");
  }
  job.arm = sim::parse_arm(options.arm);
  job.settle_band = sim::parse_number(options.settle_band, "--settle-band");
  if (job.settle_band <= 0.0 || job.settle_band > 1.0) {
    throw sim::bad_argument("--settle-band", options.settle_band, "out of range, above 0 and at most 1 is accepted");
  }
  return job;
}

void set_shapers(const std::vector<sim::SpecifiedShaper>& specs, MoveJob& job) {
  job.specs = specs;
  job.design = sim::design_for(specs, job.plain.tick_s);
}

MoveJob job_of(const MoveJobOptions& options) {
  MoveJob job = job_without_shaper(options);
  set_shapers(specs_of(options.shaper), job);
  return job;
}

sim::Comparison run_on_host(const MoveJob& job) {
  Progress progress("moving on the host");
  sim::Recording plain = sim::run_axis(job.plain, ShaperDesign{}, [&](double part) { progress.update(0.5 * part); });
  sim::Recording shaped =
      sim::run_axis(job.shaped, job.design, [&](double part) { progress.update(0.5 + 0.5 * part); });
  return sim::compare(job.plain, std::move(plain), job.shaped, std::move(shaped), job.arm, job.design.stage_count,
                      job.settle_band);
}

sim::Comparison run_within_or_least(MoveJob& job) {
  try {
    return run_on_host(job);
  } catch (const sim::Refusal& refusal) {
    if (refusal.exit_code() != 1 || job.shaped.duration_s == 0.0) throw;
  }
  job.shaped.duration_s = 0.0;
  return run_on_host(job);
}

}  // namespace stillpoint::cli

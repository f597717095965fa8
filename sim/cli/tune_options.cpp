// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/tune_options.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "sim/cli/move_output.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

constexpr double kLowestHz = 1.0;
constexpr double kHighestHz = 200.0;
constexpr double kHighestCyclesATick = 0.4;
constexpr double kAmplitudePart = 0.05;  // of the move's distance
constexpr double kTravelPart = 1.1;      // room for where an encoder that flickers has it begin

template <typename Word>
Word word_of(const std::string& text, const std::string& option, uint32_t count) {
  std::string all;
  for (uint32_t i = 0; i < count; ++i) {
    const auto word = static_cast<Word>(i);
    if (text == sim::text(word)) return word;
    all += (all.empty() ? "" : " ") + std::string(sim::text(word));
  }
  throw sim::bad_argument(option, text, "not known, accepted: " + all);
}

double not_negative(const std::string& text, const std::string& option) {
  return sim::parse_within(text, option, 0.0, 1e12);
}

void take_band(const std::string& text, sim::TuneTask& task) {
  if (text.empty()) {
    task.low_hz = kLowestHz;
    task.high_hz = std::min(kHighestHz, kHighestCyclesATick / task.move.tick_s);
    return;
  }
  std::tie(task.low_hz, task.high_hz) = band_of(text, kHighestCyclesATick / task.move.tick_s);
}

// Left out: a little more than the move takes, and a twentieth of it.
void take_room(const TuneOptions& options, sim::TuneTask& task) {
  const double unit = task.move.counts_per_unit;
  const double distance = std::abs(static_cast<double>(task.move.distance_counts));
  if (distance == 0.0) {
    throw sim::bad_argument("--distance", "0", "a move that excites nothing, one of at least a count is accepted");
  }
  task.travel_counts =
      options.travel.empty() ? kTravelPart * distance : sim::parse_positive(options.travel, "--travel") * unit;
  task.amplitude_counts = options.amplitude.empty() ? std::min(kAmplitudePart * distance, task.travel_counts)
                                                    : sim::parse_positive(options.amplitude, "--amplitude") * unit;
}

void take_drive(const MoveJob& moves, const TuneOptions& options, sim::SimulatedDriveConfig& drive) {
  const auto seed = static_cast<uint64_t>(sim::parse_integer(options.seed, "--seed", 0, INT64_MAX));
  drive.modes = moves.arm;
  drive.tick_s = moves.plain.tick_s;
  drive.counts_per_unit = moves.plain.counts_per_unit;
  drive.encoder = {kSignalPerCount, not_negative(options.encoder_noise, "--encoder-noise"), 2 * seed};
  drive.accelerometer.resolution = sim::parse_positive(options.resolution, "--resolution");
  drive.accelerometer.range = sim::parse_positive(options.range, "--range");
  drive.accelerometer.noise = not_negative(options.noise, "--noise");
  drive.accelerometer.seed = 2 * seed + 1;
  drive.reaction = sim::parse_within(options.reaction, "--reaction", 0.0, 0.5);
}

}  // namespace

TuneExcitation excitation_of(const std::string& text) {
  return word_of<TuneExcitation>(text, "--excitation", kTuneExcitations);
}

TuneSource source_of(const std::string& text) { return word_of<TuneSource>(text, "--source", kTuneSources); }

std::pair<double, double> band_of(const std::string& text, double most) {
  const std::vector<std::string> ends = sim::split(text, ':');
  if (ends.size() != 2) throw sim::bad_argument("--band", text, "not a band, LO:HI in Hz is accepted");
  const double low = sim::parse_positive(ends[0], "--band");
  const double high = sim::parse_positive(ends[1], "--band");
  if (low >= high || high > most) {
    throw sim::bad_argument("--band", text, "not a band, LO below HI up to " + sim::shortest(most) + " is accepted");
  }
  return {low, high};
}

void add_tune_options(CLI::App& app, TuneOptions& options) {
  add_value(app, "--excitation", options.excitation, "KIND",
            "what makes the arm ring: auto (default: the move, then what is needed), move, bump, stepped-sine, chirp");
  add_value(app, "--source", options.source, "SENSOR",
            "what is listened to: auto (default), accelerometer, following-error");
  add_value(app, "--amplitude", options.amplitude, "D",
            "of bump, sine and chirp, from where they begin [unit] (default: a twentieth of the distance)");
  add_value(app, "--travel", options.travel, "D",
            "room either way of the start [unit] (default: a tenth more than the distance)");
  add_value(app, "--band", options.band, "LO:HI", "where modes are looked for [Hz] (default 1:200, up to 0.4/tick)");
  add_value(app, "--tolerance", options.tolerance, "V",
            "residual tolerated over what is not known of the modes (default 0.05)");
  add_value(app, "--noise", options.noise, "A", "accelerometer noise, standard deviation [unit/s^2] (default 0.03)");
  add_value(app, "--range", options.range, "A", "the accelerometer saturates there, either way [unit/s^2]");
  add_value(app, "--resolution", options.resolution, "A", "accelerometer, a raw step [unit/s^2] (default 0.001)");
  add_value(app, "--encoder-noise", options.encoder_noise, "N", "standard deviation [counts] (default 0)");
  add_value(app, "--reaction", options.reaction, "R",
            "part of the tip's deflection by which the arm shakes its motor, 0 (default) to 0.5");
  add_value(app, "--seed", options.seed, "N", "of the noise (default 1)");
}

TuneJob job_of(const MoveJobOptions& moves, const TuneOptions& options) {
  MoveJobOptions with_zero_delay = moves;
  with_zero_delay.zero_delay = true;
  TuneJob job{job_without_shaper(with_zero_delay), {}};
  sim::TuneTask& task = job.task;
  task.move = job.moves.plain;
  task.move.zero_delay = true;
  task.excitation = excitation_of(options.excitation);
  task.source = source_of(options.source);
  take_room(options, task);
  take_band(options.band, task);
  task.tolerance = sim::parse_within(options.tolerance, "--tolerance", kMinTolerance, kMaxTolerance);
  take_drive(job.moves, options, task.drive);
  return job;
}

double unit_of(TuneSource source, const sim::TuneTask& task) {
  return source == TuneSource::kFollowingError ? 1.0 / task.move.counts_per_unit : task.drive.accelerometer.resolution;
}

Settings settings_of(const TuneJob& job) {
  Settings settings = settings_of(job.moves);
  const sim::TuneTask& task = job.task;
  const double unit = task.move.counts_per_unit;
  settings.emplace_back("excitation", sim::text(task.excitation));
  settings.emplace_back("source", sim::text(task.source));
  settings.emplace_back("amplitude", sim::shortest(task.amplitude_counts / unit) + " unit");
  settings.emplace_back("travel", sim::shortest(task.travel_counts / unit) + " unit");
  settings.emplace_back("band", sim::shortest(task.low_hz) + " to " + sim::shortest(task.high_hz) + " Hz");
  settings.emplace_back("tolerance", sim::shortest(task.tolerance));
  settings.emplace_back("accelerometer noise", sim::shortest(task.drive.accelerometer.noise) + " unit/s^2");
  settings.emplace_back("accelerometer range", sim::shortest(task.drive.accelerometer.range) + " unit/s^2");
  settings.emplace_back("accelerometer resolution", sim::shortest(task.drive.accelerometer.resolution) + " unit/s^2");
  settings.emplace_back("encoder noise", sim::shortest(task.drive.encoder.noise_counts) + " counts");
  settings.emplace_back("reaction", sim::shortest(task.drive.reaction));
  settings.emplace_back("seed", std::to_string(task.drive.encoder.seed / 2));
  return settings;
}

}  // namespace stillpoint::cli

// SPDX-License-Identifier: Apache-2.0
// `stillpoint identify`: modes from a record of residual vibration.
#include "shaper/identify/identify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "shaper/identify/quiet_start.hpp"
#include "sim/cli/command.hpp"
#include "sim/cli/csv.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/plot.hpp"
#include "sim/cli/table.hpp"
#include "sim/record_table.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

struct IdentifyOptions {
  std::string file;
  std::string rate;
  std::string column;
  std::string most_modes = "3";
  std::string from = "0";
  std::string to;
  std::string at_rest;
};

constexpr double kRestWindowS = 0.1;

struct Job {
  std::string column;
  double rate_hz = 0.0;  // of the file
  size_t first_row = 0;  // of the decay
  size_t end_row = 0;
  size_t decimation = 1;
  double first_s = 0.0;  // of the first sample used, after row 0
  double used_rate_hz = 0.0;
  std::vector<float> samples;
  Identification found{};

  // What the filter of a decimation keeps whole, or half of the rate.
  double highest_hz() const { return (decimation > 1 ? 0.35 : 0.5) * used_rate_hz; }
};

void choose_rows(const IdentifyOptions& options, const sim::RecordTable& table, Job& job) {
  const auto rows = static_cast<int64_t>(table.rows());
  const int64_t from = sim::parse_integer(options.from, "--from", 0, rows - 1);
  const int64_t to = options.to.empty() ? rows : sim::parse_integer(options.to, "--to", from + 1, rows);
  job.first_row = static_cast<size_t>(from);
  job.end_row = static_cast<size_t>(to);
  if (options.at_rest.empty()) return;
  const size_t column = sim::column_of(table, options.at_rest, "--at-rest");
  const std::vector<float> position = sim::samples_of(table, column, job.first_row, job.end_row);
  const auto window = static_cast<size_t>(std::max(2L, std::lround(kRestWindowS * job.rate_hz)));
  const size_t start = quiet_start({position.data(), position.size()}, window);
  if (start >= position.size()) {
    throw sim::Refusal(sim::Refusal::Cause::kCannot, "--at-rest", options.at_rest,
                       "never comes to rest in these rows, a longer record is accepted", text(Finding::kTooShort));
  }
  job.first_row += start;
}

Job prepared(const IdentifyOptions& options) {
  Job job;
  job.rate_hz = sim::parse_positive(options.rate, "--rate");
  const sim::RecordTable table = sim::read_record_table(options.file);
  const size_t column = sim::column_of(table, options.column, "--column");
  job.column = table.names.empty() ? std::to_string(column) : table.names[column];
  choose_rows(options, table, job);
  job.samples = sim::samples_of(table, column, job.first_row, job.end_row);
  job.decimation = (job.samples.size() + kLargestFft - 1) / kLargestFft;
  job.samples = sim::decimated(job.samples, job.decimation);
  job.used_rate_hz = job.rate_hz / static_cast<double>(job.decimation);
  const size_t delay = job.decimation > 1 ? 4 * job.decimation : 0;
  job.first_s = static_cast<double>(job.first_row + delay) / job.rate_hz;
  return job;
}

void find(const IdentifyOptions& options, Job& job) {
  static IdentifyMemory<kLargestFft> memory;
  IdentifyConfig config;
  config.rate_hz = job.used_rate_hz;
  config.most_modes = static_cast<size_t>(sim::parse_integer(options.most_modes, "--max-modes", 1, kMostComponents));
  sim::require(identify({job.samples.data(), job.samples.size()}, config, IdentifyScratch(memory), job.found));
  // The amplitude of the first row, where a filter has cut the record's beginning off.
  const double before_s = job.first_s - static_cast<double>(job.first_row) / job.rate_hz;
  for (IdentifiedMode& mode : job.found.mode) {
    mode.amplitude *= std::exp(2.0 * M_PI * mode.frequency_hz * mode.damping_ratio * before_s);
  }
}

std::vector<double> fitted(const Job& job) {
  ModelSamples model(job.found.model, job.samples.size());
  std::vector<double> values;
  for (size_t n = 0; n < job.samples.size(); ++n) values.push_back(model.next());
  return values;
}

double time_of(const Job& job, size_t n) { return job.first_s + static_cast<double>(n) / job.used_rate_hz; }

void write_csv(const std::string& path, const IdentifyOptions& options, const Job& job) {
  CsvFile csv(path, "identify",
              {{"file", options.file},
               {"column", job.column},
               {"rate", sim::shortest(job.rate_hz) + " Hz"},
               {"decimation", std::to_string(job.decimation)},
               {"result", text(job.found.finding)},
               {"record", "less its first value"}},
              {"time_s", "record", "fit", "residual"});
  const std::vector<double> fit = fitted(job);
  for (size_t n = 0; n < fit.size(); ++n) {
    const auto sample = static_cast<double>(job.samples[n]);
    csv.row(
        {sim::shortest(time_of(job, n)), sim::shortest(sample), sim::shortest(fit[n]), sim::shortest(sample - fit[n])});
  }
  csv.close();
}

// Power in decibels over its largest, with the same window as the figure's readers expect.
Panel spectrum_of(const Job& job) {
  std::vector<double> power(fft_size_for(job.samples.size()), 0.0);
  const DecayModel straight{job.found.model.offset, job.found.model.drift, 0, {}};
  ModelSamples mean(straight, job.samples.size());
  for (size_t n = 0; n < job.samples.size(); ++n) power[n] = static_cast<double>(job.samples[n]) - mean.next();
  apply_hann(power.data(), job.samples.size());
  const size_t size = power.size();
  Panel panel{"Spectrum (Hann) with the modes found", "frequency [Hz]", "power [dB]", {}, {}};
  if (!real_fft(power.data(), size)) return panel;
  to_power(power.data(), size);
  const double top = *std::max_element(power.begin(), power.begin() + static_cast<std::ptrdiff_t>(size / 2));
  const auto level = [&](size_t k) { return 10.0 * std::log10(std::max(power[k] / top, 1e-12)); };
  Series curve{"record", line_style(kPlainColour, 1), {}, {}};
  for (size_t k = 1; k < size / 2; ++k) {
    curve.x.push_back(job.used_rate_hz * static_cast<double>(k) / static_cast<double>(size));
    curve.y.push_back(level(k));
  }
  panel.series.push_back(curve);
  for (size_t i = 0; i < job.found.mode_count; ++i) {
    const IdentifiedMode& mode = job.found.mode[i];
    const double damped = mode.frequency_hz * std::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio);
    const auto k = static_cast<size_t>(std::lround(damped / job.used_rate_hz * static_cast<double>(size)));
    panel.series.push_back({fmt::format("{:.4g} Hz, zeta {:.3g}", mode.frequency_hz, mode.damping_ratio),
                            "points pt 7 ps 1",
                            {damped},
                            {level(std::min(k, size / 2 - 1))}});
  }
  return panel;
}

void draw_it(const std::string& path, const IdentifyOptions& options, const Job& job) {
  Panel record{"Record and fit, " + job.column, "time [s]", "record, less its first value", {}, {}};
  Series measured{"record", line_style(kPlainColour, 1), {}, {}};
  Series fit{"fit", line_style(kShapedColour, 1), {}, fitted(job)};
  for (size_t n = 0; n < job.samples.size(); ++n) {
    measured.x.push_back(time_of(job, n));
    measured.y.push_back(static_cast<double>(job.samples[n]));
  }
  fit.x = measured.x;
  record.series = {measured, fit};
  draw(path, Picture{"stillpoint identify " + options.file, {record, spectrum_of(job)}});
}

Json json_of(const Job& job) {
  Json modes = Json::array();
  for (size_t i = 0; i < job.found.mode_count; ++i) {
    const IdentifiedMode& mode = job.found.mode[i];
    const bool halves = mode.damping_early != 0.0 || mode.damping_late != 0.0;
    modes.push_back({{"frequency_hz", mode.frequency_hz},
                     {"damping_ratio", mode.damping_ratio},
                     {"amplitude", mode.amplitude},
                     {"frequency_std_hz", mode.frequency_std_hz},
                     {"damping_std", mode.damping_std},
                     {"confidence", mode.confidence},
                     {"viscous", mode.viscous},
                     {"damping_early", halves ? Json(mode.damping_early) : Json(nullptr)},
                     {"damping_late", halves ? Json(mode.damping_late) : Json(nullptr)}});
  }
  return {{"result", text(job.found.finding)},
          {"modes", modes},
          {"confidence", job.found.confidence},
          {"noise", job.found.noise},
          {"hum_hz", job.found.hum_hz > 0.0 ? Json(job.found.hum_hz) : Json(nullptr)},
          {"column", job.column},
          {"first_row", job.first_row},
          {"end_row", job.end_row},
          {"decimation", job.decimation},
          {"highest_hz", job.highest_hz()}};
}

void print_as_table(const Job& job) {
  fmt::print("{}: rows {} to {}, {} samples at {} Hz, so up to {} Hz; what the fit leaves: {} rms\n\n", job.column,
             job.first_row, job.end_row, job.samples.size(), figure(job.used_rate_hz), figure(job.highest_hz()),
             figure(job.found.noise));
  Table table({"mode", "frequency [Hz]", "+-", "damping ratio", "+-", "amplitude", "confidence", "viscous"});
  for (size_t i = 0; i < job.found.mode_count; ++i) {
    const IdentifiedMode& mode = job.found.mode[i];
    table.row({std::to_string(i + 1), fmt::format("{:.4f}", mode.frequency_hz),
               fmt::format("{:.4f}", mode.frequency_std_hz), fmt::format("{:.5f}", mode.damping_ratio),
               fmt::format("{:.5f}", mode.damping_std), figure(mode.amplitude), fmt::format("{:.2f}", mode.confidence),
               yes_no(mode.viscous)});
  }
  if (job.found.mode_count > 0) table.print();
  if (job.found.hum_hz > 0.0) fmt::print("A hum of {} Hz does not decay.\n", figure(job.found.hum_hz));
}

const char* why(Finding finding) {
  switch (finding) {
    case Finding::kNoMode: return "nothing in it rings and decays, a record of ringing is accepted";
    case Finding::kNoisy: return "what may ring in it cannot be told from its noise, a stronger excitation is accepted";
    case Finding::kSaturated: return "it is cut off at its extremes, a record within the sensor's range is accepted";
    default: return "it is too short, at least three periods and 32 samples are accepted";
  }
}

int run(const IdentifyOptions& options, const Output& output) {
  check_output(output);
  Job job = prepared(options);
  find(options, job);
  if (!output.csv.empty()) write_csv(output.csv, options, job);
  if (!output.plot.empty()) draw_it(output.plot, options, job);
  if (output.json) {
    print_json(json_of(job));
  } else {
    print_as_table(job);
  }
  if (job.found.finding == Finding::kFound) return 0;
  std::fflush(stdout);
  std::fprintf(stderr, "stillpoint: error: record: %s: %s\n", text(job.found.finding), why(job.found.finding));
  return 1;
}

}  // namespace

void add_identify(Commands& commands, Output& output) {
  const auto options = std::make_shared<IdentifyOptions>();
  CLI::App& app = commands.add("identify", "Modes from a record of residual vibration, and how sure they are.",
                               [options, &output] { return run(*options, output); });
  app.add_option("file", options->file, "CSV, tab-separated or LVM table of numbers")->required()->option_text("FILE");
  add_value(app, "--rate", options->rate, "HZ", "rows a second")->required();
  add_value(app, "--column", options->column, "NAME|INDEX", "the record; index from 0 (default: the last column)");
  add_value(app, "--max-modes", options->most_modes, "N", "modes reported, 1 to 4 (default 3)");
  add_value(app, "--from", options->from, "ROW", "first row, from 0 (default 0): the axis already at rest");
  add_value(app, "--to", options->to, "ROW", "row after the last (default: to the end)");
  add_value(app, "--at-rest", options->at_rest, "COLUMN", "position of the axis: start where it has come to rest");
  add_output(app, output);
}

}  // namespace stillpoint::cli

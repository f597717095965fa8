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
#include "sim/cli/identified.hpp"
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
  IdentifiedRecord record;  // its time after row 0

  // What the filter of a decimation keeps whole, or half of the rate.
  double highest_hz() const { return (decimation > 1 ? 0.35 : 0.5) * record.rate_hz; }
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
  job.record.samples = sim::samples_of(table, column, job.first_row, job.end_row);
  job.decimation = (job.record.samples.size() + kLargestFft - 1) / kLargestFft;
  job.record.samples = sim::decimated(job.record.samples, job.decimation);
  job.record.rate_hz = job.rate_hz / static_cast<double>(job.decimation);
  const size_t delay = job.decimation > 1 ? 4 * job.decimation : 0;
  job.record.first_s = static_cast<double>(job.first_row + delay) / job.rate_hz;
  return job;
}

void find(const IdentifyOptions& options, Job& job) {
  static IdentifyMemory<kLargestFft> memory;
  IdentifyConfig config;
  config.rate_hz = job.record.rate_hz;
  config.most_modes = static_cast<size_t>(sim::parse_integer(options.most_modes, "--max-modes", 1, kMostComponents));
  sim::require(identify({job.record.samples.data(), job.record.samples.size()}, config, IdentifyScratch(memory),
                        job.record.found));
  // The amplitude of the first row, where a filter has cut the record's beginning off.
  const double before_s = job.record.first_s - static_cast<double>(job.first_row) / job.rate_hz;
  for (IdentifiedMode& mode : job.record.found.mode) {
    mode.amplitude *= std::exp(2.0 * M_PI * mode.frequency_hz * mode.damping_ratio * before_s);
  }
}

void write_csv(const std::string& path, const IdentifyOptions& options, const Job& job) {
  CsvFile csv(path, "identify",
              {{"file", options.file},
               {"column", job.column},
               {"rate", sim::shortest(job.rate_hz) + " Hz"},
               {"decimation", std::to_string(job.decimation)},
               {"result", text(job.record.found.finding)},
               {"record", "less its first value"}},
              {"time_s", "record", "fit", "residual"});
  const std::vector<double> fit = fitted(job.record);
  for (size_t n = 0; n < fit.size(); ++n) {
    const auto sample = static_cast<double>(job.record.samples[n]);
    csv.row({sim::shortest(job.record.time_of(n)), sim::shortest(sample), sim::shortest(fit[n]),
             sim::shortest(sample - fit[n])});
  }
  csv.close();
}

void draw_it(const std::string& path, const IdentifyOptions& options, const Job& job) {
  draw(path, Picture{"stillpoint identify " + options.file,
                     {record_panel(job.record, "Record and fit, " + job.column, "record, less its first value"),
                      spectrum_panel(job.record)}});
}

Json json_of_job(const Job& job) {
  Json object = json_of(job.record.found);
  object["column"] = job.column;
  object["first_row"] = job.first_row;
  object["end_row"] = job.end_row;
  object["decimation"] = job.decimation;
  object["highest_hz"] = job.highest_hz();
  return object;
}

void print_as_table(const Job& job) {
  fmt::print("{}: rows {} to {}, {} samples at {} Hz, so up to {} Hz; what the fit leaves: {} rms\n\n", job.column,
             job.first_row, job.end_row, job.record.samples.size(), figure(job.record.rate_hz),
             figure(job.highest_hz()), figure(job.record.found.noise));
  print_modes(job.record.found);
}

int run(const IdentifyOptions& options, const Output& output) {
  check_output(output);
  Job job = prepared(options);
  find(options, job);
  if (!output.csv.empty()) write_csv(output.csv, options, job);
  if (!output.plot.empty()) draw_it(output.plot, options, job);
  if (output.json) {
    print_json(json_of_job(job));
  } else {
    print_as_table(job);
  }
  if (job.record.found.finding == Finding::kFound) return 0;
  std::fflush(stdout);
  std::fprintf(stderr, "stillpoint: error: record: %s: %s\n", text(job.record.found.finding),
               why(job.record.found.finding));
  return 1;
}

}  // namespace

void add_identify(Commands& commands, Output& output) {
  const auto options = std::make_shared<IdentifyOptions>();
  CLI::App& app = commands.add("identify", "Modes from a record of residual vibration, and how sure they are.",
                               [options, &output] { return run(*options, output); });
  add_required(app, "file", options->file, "FILE", "CSV, tab-separated or LVM table of numbers");
  add_required(app, "--rate", options->rate, "HZ", "rows a second");
  add_value(app, "--column", options->column, "NAME|INDEX", "the record; index from 0 (default: the last column)");
  add_value(app, "--max-modes", options->most_modes, "N", "modes reported, 1 to 4 (default 3)");
  add_value(app, "--from", options->from, "ROW", "first row, from 0 (default 0): the axis already at rest");
  add_value(app, "--to", options->to, "ROW", "row after the last (default: to the end)");
  add_value(app, "--at-rest", options->at_rest, "COLUMN", "position of the axis: start where it has come to rest");
  add_output(app, output);
}

}  // namespace stillpoint::cli

// SPDX-License-Identifier: Apache-2.0
// `stillpoint recommend`: the shortest shaper that keeps a band, and why the others lost.
#include "shaper/shaping/recommend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "sim/cli/command.hpp"
#include "sim/cli/csv.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/options.hpp"
#include "sim/cli/plot.hpp"
#include "sim/cli/progress.hpp"
#include "sim/cli/table.hpp"
#include "sim/optimal_train.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

struct RecommendOptions {
  TickOption tick;
  std::string band;
  std::string damping;
  std::string tolerance = "0.05";
  bool optimal = false;
};

struct Question {
  ModeBand band;
  double tolerance;
  double tick_s;
};

struct Answer {
  std::vector<Candidate> candidates;  // the best first
  std::optional<sim::OptimalTrain> optimal;
};

Question question_of(const RecommendOptions& options) {
  Question question{};
  question.tick_s = tick_of(options.tick);
  const std::vector<std::string> band = sim::split(options.band, ':');
  if (band.size() != 2) throw sim::bad_argument("--band", options.band, "not a band, LO:HI in Hz is accepted");
  question.band.low_hz = sim::parse_positive(band[0], "--band");
  question.band.high_hz = sim::parse_positive(band[1], "--band");
  const std::vector<std::string> damping = sim::split(options.damping, ':');
  if (damping.size() > 2) throw sim::bad_argument("--damping", options.damping, "not a range, Z or Z:Z2 is accepted");
  question.band.low_damping = sim::parse_number(damping[0], "--damping");
  question.band.high_damping =
      damping.size() == 2 ? sim::parse_number(damping[1], "--damping") : question.band.low_damping;
  question.tolerance = sim::parse_within(options.tolerance, "--tolerance", kMinTolerance, kMaxTolerance);
  sim::require(question.band.validate(question.tick_s));
  return question;
}

Answer answer_to(const Question& question, bool optimal) {
  Answer answer;
  for (uint32_t i = 0; i < kRecommendCandidates; ++i) {
    answer.candidates.push_back(try_candidate(i, question.band, question.tolerance, question.tick_s));
  }
  std::stable_sort(answer.candidates.begin(), answer.candidates.end(), is_better);
  if (optimal) {
    Progress progress("optimal train");
    answer.optimal = sim::shortest_positive_train(question.band, question.tolerance, question.tick_s,
                                                  [&](double done) { progress.update(done); });
  }
  return answer;
}

std::string spec_text(const Candidate& candidate) {
  return sim::spec_text(sim::specified(candidate.specs, candidate.spec_count));
}

// Of candidate i: why it is not the first.
std::string why(const Answer& answer, size_t i) {
  const Candidate& candidate = answer.candidates[i];
  if (candidate.keeps_band && i == 0) return "recommended";
  if (candidate.keeps_band) {
    const uint32_t longer = candidate.length_ticks - answer.candidates[0].length_ticks;
    return longer == 0 ? "as short, delays more or the same" : fmt::format("{} ticks longer", longer);
  }
  return fmt::format("leaves {:.2f} % at {:.4g} Hz", 100.0 * candidate.worst.residual, candidate.worst.frequency_hz);
}

bool optimal_is_shorter(const Answer& answer) {
  if (!answer.optimal) return false;
  const Candidate& best = answer.candidates[0];
  return !best.keeps_band || answer.optimal->length_ticks < best.length_ticks;
}

Json impulses_of(const sim::OptimalTrain& train, double tick_s) {
  Json impulses = Json::array();
  for (const sim::ImpulseTap& tap : train.taps) {
    impulses.push_back({{"time_s", tap.delay_ticks * tick_s}, {"amplitude", static_cast<double>(tap.gain)}});
  }
  return impulses;
}

Json json_of(const Question& question, const Answer& answer) {
  const Candidate& best = answer.candidates[0];
  Json object = {{"result", best.keeps_band || answer.optimal ? "ok" : "no_shaper"}};
  if (best.keeps_band) object["shaper"] = spec_text(best);
  if (answer.optimal) {
    object["impulses"] = impulses_of(*answer.optimal, question.tick_s);
    object["optimal_length_ticks"] = answer.optimal->length_ticks;
  }
  const bool by_train = optimal_is_shorter(answer);
  object["length_ticks"] = by_train ? answer.optimal->length_ticks : best.length_ticks;
  object["worst_residual"] = by_train ? answer.optimal->worst_residual : best.worst.residual;
  Json candidates = Json::array();
  for (size_t i = 0; i < answer.candidates.size(); ++i) {
    const Candidate& candidate = answer.candidates[i];
    if (candidate.spec_count == 0) continue;
    candidates.push_back({{"shaper", spec_text(candidate)},
                          {"length_ticks", candidate.length_ticks},
                          {"worst_residual", candidate.worst.residual},
                          {"worst_frequency_hz", candidate.worst.frequency_hz},
                          {"delay_s", candidate.delay_ticks * question.tick_s},
                          {"keeps_band", candidate.keeps_band},
                          {"why", why(answer, i)}});
  }
  object["candidates"] = candidates;
  return object;
}

void print_as_table(const Question& question, const Answer& answer) {
  Table table({"shaper", "length [ticks]", "worst residual [%]", "delay [s]", ""});
  for (size_t i = 0; i < answer.candidates.size(); ++i) {
    const Candidate& candidate = answer.candidates[i];
    if (candidate.spec_count == 0) continue;
    table.row({spec_text(candidate), std::to_string(candidate.length_ticks),
               fmt::format("{:.3f}", 100.0 * candidate.worst.residual),
               fmt::format("{:.6f}", candidate.delay_ticks * question.tick_s), why(answer, i)});
  }
  table.print();
  if (!answer.optimal) return;
  fmt::print("\nThe shortest positive train that any method can find: {} ticks, {} impulses, worst residual {:.3f} %\n",
             answer.optimal->length_ticks, answer.optimal->taps.size(), 100.0 * answer.optimal->worst_residual);
}

// What `custom:F:Z:file=` reads: the optimal train where it was asked for, else the taps of the recommended one.
void write_csv(const std::string& path, const Question& question, const Answer& answer) {
  Settings settings = {{"tick", sim::shortest(question.tick_s) + " s"},
                       {"band", fmt::format("{}:{} Hz", question.band.low_hz, question.band.high_hz)},
                       {"damping", fmt::format("{}:{}", question.band.low_damping, question.band.high_damping)},
                       {"tolerance", sim::shortest(question.tolerance)}};
  std::vector<sim::ImpulseTap> taps;
  if (answer.optimal) {
    taps = answer.optimal->taps;
  } else {
    settings.emplace_back("shaper", spec_text(answer.candidates[0]));
    taps = sim::multiplied_out(sim::design_for(sim::parse_shapers(spec_text(answer.candidates[0])), question.tick_s),
                               sim::kMostTaps);
  }
  CsvFile csv(path, "recommend", settings, {"time_s", "amplitude"});
  for (const sim::ImpulseTap& tap : taps) {
    csv.row({sim::shortest(tap.delay_ticks * question.tick_s), sim::shortest(static_cast<double>(tap.gain))});
  }
  csv.close();
}

Series curve_of(const Question& question, const ShaperDesign& design, const std::string& label,
                const std::string& style) {
  Series series{label, style, {}, {}};
  constexpr int kPoints = 600;
  const double width = question.band.high_hz - question.band.low_hz;
  const double from = std::max(question.band.low_hz - 0.5 * width, 0.2 * question.band.low_hz);
  const double to = std::min(question.band.high_hz + 0.5 * width, 0.5 / question.tick_s);
  for (int i = 0; i <= kPoints; ++i) {
    const Mode mode{from + (to - from) * i / kPoints, question.band.low_damping};
    series.x.push_back(mode.frequency_hz);
    series.y.push_back(100.0 * static_cast<double>(sim::residual_on_grid(design, mode, question.tick_s)));
  }
  return series;
}

Picture picture_of(const Question& question, const Answer& answer) {
  constexpr const char* kColours[] = {kShapedColour, "#1b9e77", "#7570b3", "#e7298a"};
  Panel panel{"The shortest shapers that keep the band", "frequency of the arm [Hz]", "residual [%]", {}, {}};
  for (size_t i = 0; i < std::size(kColours) && answer.candidates[i].keeps_band; ++i) {
    const std::string label = spec_text(answer.candidates[i]);
    const ShaperDesign design = sim::design_for(sim::parse_shapers(label), question.tick_s);
    panel.series.push_back(curve_of(question, design, label, line_style(kColours[i], i == 0 ? 2.5 : 1.2)));
  }
  Series wanted{"band and tolerance", line_style(kPlainColour, 2, true), {}, {}};
  wanted.x = {question.band.low_hz, question.band.high_hz};
  wanted.y = {100.0 * question.tolerance, 100.0 * question.tolerance};
  panel.series.push_back(wanted);
  panel.y_range = {0.0, 400.0 * question.tolerance};
  return Picture{"stillpoint recommend", {panel}};
}

int run(const RecommendOptions& options, const Output& output) {
  check_output(output);
  const Question question = question_of(options);
  const Answer answer = answer_to(question, options.optimal);
  const bool found = answer.candidates[0].keeps_band;
  if (found && !output.plot.empty()) draw(output.plot, picture_of(question, answer));
  if ((found || answer.optimal) && !output.csv.empty()) write_csv(output.csv, question, answer);
  if (output.json) {
    print_json(json_of(question, answer));
  } else {
    print_as_table(question, answer);
  }
  if (found || answer.optimal) return 0;
  std::fprintf(stderr,
               "stillpoint: error: --band: %s: no shaper of the family keeps it, a narrower band or a tolerance of at "
               "least %s is accepted\n",
               options.band.c_str(), figure(answer.candidates[0].worst.residual).c_str());
  return 1;
}

}  // namespace

void add_recommend(Commands& commands, Output& output) {
  const auto options = std::make_shared<RecommendOptions>();
  CLI::App& app =
      commands.add("recommend", "The shortest shaper that keeps a band of frequencies, and why others lost.",
                   [options, &output] { return run(*options, output); });
  add_tick(app, options->tick);
  add_required(app, "--band", options->band, "LO:HI", "frequencies that the arm's mode may have, in Hz");
  add_required(app, "--damping", options->damping, "Z[:Z2]", "its damping ratio, or the range of it");
  add_value(app, "--tolerance", options->tolerance, "V", "residual tolerated all over the band (default 0.05)");
  add_flag(app, "--optimal", options->optimal,
           "find the shortest positive train as well, by a linear programme; --csv writes it for custom:F:Z:file=");
  add_output(app, output);
}

}  // namespace stillpoint::cli

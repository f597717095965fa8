// SPDX-License-Identifier: Apache-2.0
// `stillpoint shape`: a filter for streams of counts.
#include <cstdio>
#include <iostream>
#include <memory>

#include "shaper/shaping/shaper.hpp"
#include "sim/cli/command.hpp"
#include "sim/cli/options.hpp"
#include "sim/refusal.hpp"
#include "sim/retuned_stream.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

// A shaper with its own memory, that knows when its line holds nothing but what stands.
class Filter {
 public:
  explicit Filter(const ShaperDesign& design) { configure(design); }

  // Only while at rest.
  void configure(const ShaperDesign& design) {
    memory_.assign(Shaper::memory_needed(design) + 1, LineSample{0, 0});
    sim::require(shaper_.configure(design, memory_.data(), memory_.size(), input_));
    length_ = design.length_ticks();
    same_ = length_;
  }

  Signal tick(Signal input) {
    same_ = input != input_ ? 0 : same_ + (same_ < length_ ? 1U : 0U);
    input_ = input;
    return shaper_.tick(input);
  }

  Signal input() const { return input_; }
  // The output has followed completely.
  bool at_rest() const { return same_ >= length_; }

 private:
  Shaper shaper_;
  std::vector<LineSample> memory_;
  Signal input_ = 0;
  uint32_t length_ = 0;
  uint32_t same_ = 0;  // ticks since the input changed, up to length_
};

void print(Signal setpoint) {
  const std::string text = sim::exact_counts(setpoint);
  if (std::puts(text.c_str()) < 0) {
    throw sim::bad_argument("standard output", "write", "failed, a file or pipe with room is accepted");
  }
}

std::vector<sim::StreamRetune> retunes_of(const std::vector<std::string>& texts, double tick_s) {
  std::vector<sim::StreamRetune> retunes;
  for (const std::string& text : texts) {
    const size_t equals = text.find('=');
    if (equals == std::string::npos) {
      throw sim::bad_argument("--retune", text, "not TICK=SPEC, e.g. 200=zvd:11:0.11 is accepted");
    }
    const auto tick = static_cast<size_t>(sim::parse_integer(text.substr(0, equals), "--retune", 0, INT64_MAX));
    if (!retunes.empty() && tick < retunes.back().tick) {
      throw sim::bad_argument("--retune", text, "earlier than the one before it, rising ticks are accepted");
    }
    retunes.push_back({tick, sim::design_for(sim::parse_shapers(text.substr(equals + 1)), tick_s)});
  }
  return retunes;
}

// A line without what editors and other systems leave around the number.
std::string trimmed(const std::string& line) {
  const size_t first = line.find_first_not_of(" \t\r");
  if (first == std::string::npos) return "";
  return line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
}

// Calls take(input) for each line of standard input.
template <typename Take>
void read_counts(const Take& take) {
  std::string line;
  for (size_t number = 1; std::getline(std::cin, line); ++number) {
    const std::string what = "standard input, line " + std::to_string(number);
    take(signal_from_counts(
        static_cast<int32_t>(sim::parse_integer(trimmed(line), what, kMinPositionCounts, kMaxPositionCounts))));
  }
}

[[noreturn]] void refuse_late(const std::string& retune, size_t end) {
  throw sim::bad_argument(
      "--retune", retune,
      "the stream ended at tick " + std::to_string(end) + " before it, an earlier tick is accepted");
}

// The room for a blend is in what comes, so all of it is read first.
int run_blended(const ShaperDesign& first, const std::vector<sim::StreamRetune>& retunes,
                const std::vector<std::string>& retune_texts, const AxisLimits& limits, double tick_s) {
  std::vector<Signal> input;
  read_counts([&](Signal counts) { input.push_back(counts); });
  const sim::RetunedStream stream = sim::retuned(input, first, retunes, limits, tick_s);
  for (const Signal setpoint : stream.output) print(setpoint);
  const size_t taken = stream.active_from.size();
  if (taken < retunes.size()) refuse_late(retune_texts[taken], stream.output.size());
  return 0;
}

int run(const ShaperOption& shaper, const std::vector<std::string>& retune_texts, const LimitOptions& limits,
        const TickOption& tick) {
  const double tick_s = tick_of(tick);
  const ShaperDesign first = sim::design_for(specs_of(shaper), tick_s);
  const std::vector<sim::StreamRetune> retunes = retunes_of(retune_texts, tick_s);
  if (limits.given()) return run_blended(first, retunes, retune_texts, limits_of(limits), tick_s);
  Filter filter(first);
  size_t next = 0;
  size_t now = 0;
  const auto step = [&](Signal input) {
    // At its tick, or at the first moment of rest after it. A new input of this tick already goes through the new one.
    while (next < retunes.size() && retunes[next].tick <= now && filter.at_rest()) {
      filter.configure(retunes[next++].design);
    }
    print(filter.tick(input));
    ++now;
  };
  read_counts(step);
  while (!filter.at_rest()) step(filter.input());
  if (next < retunes.size()) refuse_late(retune_texts[next], now);
  return 0;
}

}  // namespace

void add_shape(Commands& commands) {
  const auto shaper = std::make_shared<ShaperOption>();
  const auto retunes = std::make_shared<std::vector<std::string>>();
  const auto limits = std::make_shared<LimitOptions>();
  const auto tick = std::make_shared<TickOption>();
  CLI::App& app = commands.add("shape",
                               "Filters counts, one a line on standard input, one a tick: shaped setpoints on standard "
                               "output, exact decimals of a count, until the line has drained.",
                               [shaper, retunes, limits, tick] { return run(*shaper, *retunes, *limits, *tick); });
  add_shaper(app, *shaper);
  add_values(
      app, "--retune", *retunes, "TICK=SPEC",
      "change to other shapers at that tick (the first line is tick 0), or when at rest next; with limits, blended "
      "before that where they leave room; may be repeated");
  add_limits(app, *limits);
  add_tick(app, *tick);
}

}  // namespace stillpoint::cli

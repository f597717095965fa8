// SPDX-License-Identifier: Apache-2.0
#include "sim/park.hpp"

#include <algorithm>
#include <cmath>

#include "shaper/shaping/shaper.hpp"
#include "sim/refusal.hpp"
#include "sim/residual_curve.hpp"
#include "sim/spec.hpp"

namespace stillpoint::sim {
namespace {

constexpr double kDesignHz = 4.0;
constexpr double kPercent = 100.0;
constexpr Band kLookedAt{0.2, 4.0};  // as far as the reference looks; four humps at zeta 0.1 have no upper edge there

constexpr ShaperKind kConvolution[] = {ShaperKind::kCv1, ShaperKind::kCv2, ShaperKind::kCv3, ShaperKind::kCv4};
constexpr ShaperKind kExtraInsensitive[] = {ShaperKind::kEi, ShaperKind::kEi2, ShaperKind::kEi3};

// A shaper twice: as designed, and as it runs.
struct Pair {
  double damping_ratio;
  std::vector<ExactImpulse> continuous;
  std::vector<ExactImpulse> as_run;
};

Pair pair_of(ShaperKind kind, double damping_ratio) {
  const SpecifiedShaper spec = shaper_spec(kind, {kDesignHz, damping_ratio});
  return Pair{damping_ratio, continuous_impulses(spec), impulses_as_run(design_for({spec}, kParkTick), kParkTick)};
}

// Over the plants' frequency, at the damping designed for.
ResidualCurve calculated(const Pair& pair) {
  return [&pair](double f) { return residual(pair.continuous, {f, pair.damping_ratio}); };
}
ResidualCurve measured(const Pair& pair) {
  return [&pair](double f) { return residual_on_plant(pair.as_run, TwoMassParameters::of({f, pair.damping_ratio})); };
}

std::string humps_text(size_t humps) { return std::to_string(humps) + (humps == 1 ? " hump" : " humps"); }

struct Landmarks {
  std::vector<double> zeros_hz;
  std::vector<double> humps;
  Band band;
};

Landmarks landmarks_of(const ResidualCurve& curve) {
  Landmarks marks{zeros_of(curve, kLookedAt.low_ratio * kDesignHz, 2.0 * kDesignHz, 0.01 * kDesignHz), {}, {}};
  for (size_t i = 0; i + 1 < marks.zeros_hz.size(); ++i)
    marks.humps.push_back(hump_between(curve, marks.zeros_hz[i], marks.zeros_hz[i + 1]));
  marks.band = band_of(curve, kDesignHz, kDefaultTolerance, kLookedAt);
  return marks;
}

// Humps that Park sets to the tolerance: from the bottom up to the middle. Those above come out lower.
bool is_set(size_t hump, size_t humps) { return 2 * hump < humps; }

void add_landmarks(size_t humps, std::vector<ParkRow>& rows) {
  const Pair cv = pair_of(kConvolution[humps - 1], 0.1);
  const Landmarks ours = landmarks_of(calculated(cv));
  const Landmarks plant = landmarks_of(measured(cv));
  const std::string name = std::to_string(humps) + "-hump CV: ";
  const auto count = [](const Landmarks& marks) { return static_cast<double>(marks.humps.size()); };
  rows.push_back({10, name + "humps", "", static_cast<double>(humps), count(ours), count(plant)});
  for (size_t i = 0; i < std::min(ours.zeros_hz.size(), plant.zeros_hz.size()); ++i) {
    rows.push_back(
        {10, name + "zero " + std::to_string(i + 1), "Hz", std::nullopt, ours.zeros_hz[i], plant.zeros_hz[i]});
  }
  for (size_t i = 0; i < std::min(ours.humps.size(), plant.humps.size()); ++i) {
    const std::optional<double> paper = is_set(i, humps) ? std::optional(kPercent * kDefaultTolerance) : std::nullopt;
    rows.push_back(
        {10, name + "hump " + std::to_string(i + 1), "%", paper, kPercent * ours.humps[i], kPercent * plant.humps[i]});
  }
  rows.push_back({10, name + "5 % from", "f", std::nullopt, ours.band.low_ratio, plant.band.low_ratio});
  const bool ends = ours.band.high_ratio < kLookedAt.high_ratio;
  rows.push_back({10, name + (ends ? "5 % up to" : "5 % up to at least"), "f", std::nullopt, ours.band.high_ratio,
                  plant.band.high_ratio});
}

struct Size {
  double length_s;
  double width;  // of the band, over f
};

Size size_of(const std::vector<ExactImpulse>& impulses, const ResidualCurve& curve) {
  const Band band = band_of(curve, kDesignHz, kDefaultTolerance, kLookedAt);
  return Size{static_cast<double>(impulses.back().time_s), band.high_ratio - band.low_ratio};
}

// `cv` humps of CV over `ei` humps of EI, undamped.
void add_ratios(size_t cv, size_t ei, std::optional<double> paper_length, std::optional<double> paper_width,
                std::vector<ParkRow>& rows) {
  const Pair over = pair_of(kConvolution[cv - 1], 0.0);
  const Pair under = pair_of(kExtraInsensitive[ei - 1], 0.0);
  const auto more = [](double a, double b) { return kPercent * (a / b - 1.0); };
  const Size ours[] = {size_of(over.continuous, calculated(over)), size_of(under.continuous, calculated(under))};
  const Size plant[] = {size_of(over.as_run, measured(over)), size_of(under.as_run, measured(under))};
  const std::string name = (cv == ei ? humps_text(cv) + ", CV over EI: " : "4-hump CV over 3-hump EI: ");
  rows.push_back({13, name + "length", "+%", paper_length, more(ours[0].length_s, ours[1].length_s),
                  more(plant[0].length_s, plant[1].length_s)});
  rows.push_back(
      {13, name + "band", "+%", paper_width, more(ours[0].width, ours[1].width), more(plant[0].width, plant[1].width)});
}

std::vector<double> response_of(const std::vector<ExactImpulse>& impulses, const TwoMassParameters& plant,
                                size_t ticks) {
  TwoMasses masses(plant);
  std::vector<double> positions;
  size_t next = 0;
  for (size_t i = 0; i < ticks; ++i) {
    const long double now = static_cast<long double>(i) * static_cast<long double>(kParkTick);
    for (; next < impulses.size() && impulses[next].time_s <= now; ++next) masses.step(impulses[next].amplitude);
    positions.push_back(static_cast<double>(masses.far_position()));
    masses.advance(static_cast<long double>(kParkTick));
  }
  return positions;
}

struct PaperResponse {
  int figure;
  TwoMassParameters plant;
  double design_damping_ratio;
  double extra_insensitive_percent;
  double convolution_percent;
};

void add_response(const PaperResponse& paper, ParkExperiments& all) {
  const Pair ei = pair_of(ShaperKind::kEi3, paper.design_damping_ratio);
  const Pair cv = pair_of(ShaperKind::kCv3, paper.design_damping_ratio);
  const auto add = [&](const char* name, double printed, const Pair& pair) {
    all.rows.push_back({paper.figure, name, "%", printed,
                        kPercent * static_cast<double>(residual(pair.continuous, paper.plant.mode())),
                        kPercent * static_cast<double>(residual_on_plant(pair.as_run, paper.plant))});
  };
  add("3-hump EI: left of a step", paper.extra_insensitive_percent, ei);
  add("3-hump CV: left of a step", paper.convolution_percent, cv);
  constexpr size_t kTicks = 1500;  // both trains end before half of it
  all.responses.push_back({paper.figure, paper.plant, response_of(ei.as_run, paper.plant, kTicks),
                           response_of(cv.as_run, paper.plant, kTicks)});
}

}  // namespace

std::vector<ExactImpulse> impulses_as_run(const ShaperDesign& design, double tick_s) {
  constexpr int32_t kStepCounts = 1 << 20;  // a power of two: every amplitude is exact
  std::vector<LineSample> line(Shaper::memory_needed(design));
  Shaper shaper;
  require(shaper.configure(design, line.data(), line.size(), 0));
  const long double scale = static_cast<long double>(kStepCounts) * static_cast<long double>(kSignalPerCount);
  std::vector<ExactImpulse> impulses;
  Signal before = 0;
  for (uint32_t tick = 0; tick <= design.length_ticks(); ++tick) {
    const Signal now = shaper.tick(signal_from_counts(kStepCounts));
    if (now == before && tick < design.length_ticks()) continue;
    impulses.push_back({static_cast<long double>(tick) * static_cast<long double>(tick_s),
                        static_cast<long double>(now - before) / scale});
    before = now;
  }
  return impulses;
}

long double residual_on_plant(const std::vector<ExactImpulse>& impulses, const TwoMassParameters& plant) {
  TwoMasses shaped(plant);
  long double now = 0.0L;
  for (const ExactImpulse& impulse : impulses) {
    shaped.advance(impulse.time_s - now);
    shaped.step(impulse.amplitude);
    now = impulse.time_s;
  }
  TwoMasses unshaped(plant);
  unshaped.step(1.0L);
  return shaped.amplitude() / unshaped.amplitude();
}

ParkExperiments run_park() {
  ParkExperiments all;
  for (const size_t humps : {3U, 4U}) add_landmarks(humps, all.rows);
  add_ratios(1, 1, 2.0, 8.0, all.rows);
  add_ratios(2, 2, 8.0, 6.0, all.rows);
  add_ratios(3, 3, 16.0, 26.0, all.rows);
  add_ratios(4, 3, std::nullopt, std::nullopt, all.rows);
  add_response({15, {1.0, 632.0, 0.0}, 0.0, 5.0, 5.0}, all);
  add_response({16, {1.0, 1826.0, 0.0}, 0.0, 50.0, 5.0}, all);
  add_response({17, {1.0, 2526.0, 10.05}, 0.1, 26.0, 4.0}, all);
  return all;
}

}  // namespace stillpoint::sim

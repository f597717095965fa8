// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/identified.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "shaper/identify/decay_model.hpp"
#include "shaper/identify/fft.hpp"
#include "sim/cli/json.hpp"
#include "sim/cli/table.hpp"

namespace stillpoint::cli {
namespace {

Json json_of(const IdentifiedMode& mode) {
  const bool halves = mode.damping_early != 0.0 || mode.damping_late != 0.0;
  return {{"frequency_hz", mode.frequency_hz},
          {"damping_ratio", mode.damping_ratio},
          {"amplitude", mode.amplitude},
          {"frequency_std_hz", mode.frequency_std_hz},
          {"damping_std", mode.damping_std},
          {"confidence", mode.confidence},
          {"viscous", mode.viscous},
          {"damping_early", halves ? Json(mode.damping_early) : Json(nullptr)},
          {"damping_late", halves ? Json(mode.damping_late) : Json(nullptr)}};
}

}  // namespace

IdentifiedRecord scaled(const IdentifiedRecord& record, double scale) {
  IdentifiedRecord other = record;
  for (float& sample : other.samples) sample = static_cast<float>(static_cast<double>(sample) * scale);
  Identification& found = other.found;
  found.noise *= scale;
  for (IdentifiedMode& mode : found.mode) mode.amplitude *= scale;
  found.model.offset *= scale;
  found.model.drift *= scale;
  for (Component& component : found.model.component) {
    component.cosine *= scale;
    component.sine *= scale;
  }
  return other;
}

std::vector<double> fitted(const IdentifiedRecord& record) {
  ModelSamples model(record.found.model, record.samples.size());
  std::vector<double> values;
  for (size_t n = 0; n < record.samples.size(); ++n) values.push_back(model.next());
  return values;
}

Json json_of(const Identification& found) {
  Json modes = Json::array();
  for (size_t i = 0; i < found.mode_count; ++i) modes.push_back(json_of(found.mode[i]));
  return {{"result", text(found.finding)},
          {"modes", modes},
          {"confidence", found.confidence},
          {"noise", found.noise},
          {"hum_hz", found.hum_hz > 0.0 ? Json(found.hum_hz) : Json(nullptr)}};
}

void print_modes(const Identification& found) {
  Table table({"mode", "frequency [Hz]", "+-", "damping ratio", "+-", "amplitude", "confidence", "viscous"});
  for (size_t i = 0; i < found.mode_count; ++i) {
    const IdentifiedMode& mode = found.mode[i];
    table.row({std::to_string(i + 1), fmt::format("{:.4f}", mode.frequency_hz),
               fmt::format("{:.4f}", mode.frequency_std_hz), fmt::format("{:.5f}", mode.damping_ratio),
               fmt::format("{:.5f}", mode.damping_std), figure(mode.amplitude), fmt::format("{:.2f}", mode.confidence),
               yes_no(mode.viscous)});
  }
  if (found.mode_count > 0) table.print();
  if (found.hum_hz > 0.0) fmt::print("A hum of {} Hz does not decay.\n", figure(found.hum_hz));
}

const char* why(Finding finding) {
  switch (finding) {
    case Finding::kNoMode: return "nothing in it rings and decays, a record of ringing is accepted";
    case Finding::kNoisy: return "what may ring in it cannot be told from its noise, a stronger excitation is accepted";
    case Finding::kSaturated: return "it is cut off at its extremes, a record within the sensor's range is accepted";
    case Finding::kTravelLimit: return "there is no room to excite the arm, a longer --travel is accepted";
    case Finding::kAborted: return "the axis was stopped, a tuning without a fault or a stop is accepted";
    default: return "it is too short, at least three periods and 32 samples are accepted";
  }
}

Panel record_panel(const IdentifiedRecord& record, const std::string& title, const std::string& unit) {
  Series measured{"record", line_style(kPlainColour, 1), {}, {}};
  Series fit{"fit", line_style(kShapedColour, 1), {}, fitted(record)};
  for (size_t n = 0; n < record.samples.size(); ++n) {
    measured.x.push_back(record.time_of(n));
    measured.y.push_back(static_cast<double>(record.samples[n]));
  }
  fit.x = measured.x;
  return Panel{title, "time [s]", unit, {}, {measured, fit}};
}

// Power in decibels over its largest, with the same window as the figure's readers expect.
Panel spectrum_panel(const IdentifiedRecord& record) {
  const Identification& found = record.found;
  std::vector<double> power(fft_size_for(record.samples.size()), 0.0);
  const DecayModel straight{found.model.offset, found.model.drift, 0, {}};
  ModelSamples mean(straight, record.samples.size());
  for (size_t n = 0; n < record.samples.size(); ++n) power[n] = static_cast<double>(record.samples[n]) - mean.next();
  apply_hann(power.data(), record.samples.size());
  const size_t size = power.size();
  Panel panel{"Spectrum (Hann) with the modes found", "frequency [Hz]", "power [dB]", {}, {}};
  if (!real_fft(power.data(), size)) return panel;
  to_power(power.data(), size);
  const double top = *std::max_element(power.begin(), power.begin() + static_cast<std::ptrdiff_t>(size / 2));
  const auto level = [&](size_t k) { return 10.0 * std::log10(std::max(power[k] / top, 1e-12)); };
  Series curve{"record", line_style(kPlainColour, 1), {}, {}};
  for (size_t k = 1; k < size / 2; ++k) {
    curve.x.push_back(record.rate_hz * static_cast<double>(k) / static_cast<double>(size));
    curve.y.push_back(level(k));
  }
  panel.series.push_back(curve);
  for (size_t i = 0; i < found.mode_count; ++i) {
    const IdentifiedMode& mode = found.mode[i];
    const double damped = mode.frequency_hz * std::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio);
    const auto k = static_cast<size_t>(std::lround(damped / record.rate_hz * static_cast<double>(size)));
    panel.series.push_back({fmt::format("{:.4g} Hz, zeta {:.3g}", mode.frequency_hz, mode.damping_ratio),
                            "points pt 7 ps 1",
                            {damped},
                            {level(std::min(k, size / 2 - 1))}});
  }
  return panel;
}

}  // namespace stillpoint::cli

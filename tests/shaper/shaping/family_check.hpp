// SPDX-License-Identifier: Apache-2.0
// One random design of the family as it runs, in integers, held against its continuous shaper. For the test of a few
// seconds and the campaign of any length.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "shaper/shaping/prototype.hpp"
#include "tests/shaper/shaping/residual_oracle.hpp"
#include "tests/support/random.hpp"

namespace stillpoint::testing {

constexpr double kFamilyTick = 1e-3;
constexpr double kTwoSidedHz = 100.0;

// What is asked: from both sides up to kTwoSidedHz, above only what is higher or narrower.
constexpr Real kHumpAsked = 1e-3L;
constexpr Real kEdgeAsked = 1e-2L;

struct Checked {
  bool refused = false;
  bool sums_to_one = true;
  bool gains_fit = true;     // what Shaper::tick can take: |gains| of a stage below 4
  bool negative = false;     // a negative tap
  bool unannounced = false;  // and the report does not say so
  Real at_mode = 0;          // V there, where a zero stands there by design
  Real hump = 0;             // worst miss, of V
  Real excess = 0;           // the most by which a hump passes the tolerance, relative
  Real edge = 0;             // worst miss, of the edge; above kTwoSidedHz what is narrower
  bool touching = false;     // an edge hangs on a lobe that all but touches the tolerance
  double band_miss = 0.0;
  double peak_gain = 1.0;
};

inline bool has_zero_at_mode(ShaperKind kind) {
  return kind == ShaperKind::kEi2 || kind == ShaperKind::kCv2 || kind == ShaperKind::kCv4 ||
         (humps_of(kind) == 0 && kind != ShaperKind::kCustom);
}

// Zeros of a train are all it has; with one at the mode alone nothing is done for its band.
inline bool has_band(ShaperKind kind) {
  return humps_of(kind) > 0 || (kind >= ShaperKind::kZvd && kind < ShaperKind::kMzv);
}

inline void check_gains(const ShaperDesign& design, bool train_has_negative, const PlacementReport& report,
                        Checked& out) {
  for (uint32_t s = 0; s < design.stage_count; ++s) {
    int64_t sum = 0;
    int64_t size = 0;
    for (uint32_t i = 0; i < design.stages[s].tap_count; ++i) {
      const int64_t gain = design.taps[design.stages[s].first_tap + i].gain;
      sum += gain;
      size += gain < 0 ? -gain : gain;
      out.negative = out.negative || gain < 0;
    }
    out.sums_to_one = out.sums_to_one && sum == kUnityGain;
    out.gains_fit = out.gains_fit && size < INT64_C(4) * kUnityGain;
  }
  out.unannounced = out.negative && !train_has_negative && !report.has_negative_tap;
  out.peak_gain = design.peak_gain();
}

class BandCheck {
 public:
  BandCheck(const Prototype& prototype, const Cascade& taps, const ShaperSpec& spec)
      : prototype_(prototype),
        taps_(taps),
        zeta_(spec.mode.damping_ratio),
        tolerance_(spec.tolerance),
        cycles_(static_cast<Real>(spec.mode.frequency_hz) * static_cast<Real>(kFamilyTick)),
        two_sided_(spec.mode.frequency_hz <= kTwoSidedHz) {}

  // Between the zeros that run, or, where one has moved off the mode's damping, between what the mode sees of them:
  // either reading of where a hump begins and ends will do.
  void humps(Checked& out) const {
    Real zeros[kMaxZeros];
    Real minima[kMaxZeros];
    find_zeros_that_run(zeros);
    find_minima_that_run(minima);
    for (uint32_t j = 0; j + 1 < prototype_.zero_count; ++j) {
      const Real wanted = extreme_between(prototype_.train, zeta_, zero(j), zero(j + 1), 1, samples(j)).residual;
      Real run = extreme_between(taps_, zeta_, zeros[j], zeros[j + 1], 1, samples(j)).residual;
      const Real seen = extreme_between(taps_, zeta_, minima[j], minima[j + 1], 1, samples(j)).residual;
      if (std::abs(seen - wanted) < std::abs(run - wanted)) run = seen;
      out.hump = std::max(out.hump, std::abs(run - wanted));
      out.excess = std::max(out.excess, run / tolerance_ - 1);
    }
  }

  void edges(Checked& out) const {
    const Real limit = std::min(6.0L, 0.5L / cycles_);
    edge(zero(0), 0, out);
    edge(zero(prototype_.zero_count - 1), limit, out);
  }

 private:
  static constexpr Real kTurn = 2 * 3.14159265358979323846264338327950288L;

  Real zero(uint32_t k) const { return prototype_.zeros[k].ratio; }
  // On the ticks a zero may stand at another frequency and damping: Newton on sum A_i exp(s t_i) in complex s, those of
  // the same part already found divided out. Of a cascade each stage has its own.
  void find_zeros_that_run(Real* frequency) const {
    using Complex = std::complex<Real>;
    Complex zeros[kMaxZeros];
    for (uint32_t k = 0; k < prototype_.zero_count; ++k) {
      const Cascade::Part& part = taps_.parts[prototype_.is_cascade ? k : 0];
      const Real w = kTurn * cycles_ * zero(k);
      Complex s(zeta_ * w, w * std::sqrt(1 - zeta_ * zeta_));
      for (int i = 0; i < 40; ++i) {
        Complex step = 1.0L / relative_slope(part, s);
        for (uint32_t j = 0; !prototype_.is_cascade && j < k; ++j) step = step / (1.0L - step / (s - zeros[j]));
        s -= step;
      }
      zeros[k] = s;
      frequency[k] = std::abs(s) / kTurn;
    }
    std::sort(frequency, frequency + prototype_.zero_count);
  }
  std::complex<Real> relative_slope(const Cascade::Part& part, const std::complex<Real>& s) const {
    std::complex<Real> value = 0;
    std::complex<Real> slope = 0;
    for (uint32_t n = part.first; n < part.first + part.count; ++n) {
      const Real time = taps_.impulses[n].time;
      const std::complex<Real> term = static_cast<Real>(taps_.impulses[n].amplitude) * std::exp(s * time);
      value += term;
      slope += time * term;
    }
    return slope / (value == std::complex<Real>(0) ? std::complex<Real>(1e-30L) : value);
  }
  // What the mode sees of a zero at another damping is where least is left.
  void find_minima_that_run(Real* frequency) const {
    constexpr int kSamples = 400;
    const uint32_t count = prototype_.zero_count;
    for (uint32_t k = 0; k < count; ++k) {
      const Real low = k == 0 ? 0.7L * zero(0) : std::sqrt(zero(k - 1) * zero(k));
      const Real high = k + 1 == count ? 1.4L * zero(k) : std::sqrt(zero(k) * zero(k + 1));
      Real least = 2;
      for (int i = 0; i <= kSamples; ++i) {
        const Real at = cycles_ * (low + (high - low) * i / kSamples);
        const Real left = residual_ratio(taps_, at, zeta_);
        if (left >= least) continue;
        least = left;
        frequency[k] = at;
      }
    }
  }
  // A wide hump may have several tops.
  int samples(uint32_t j) const { return zero(j + 1) > 1.5L * zero(j) ? 80 : 16; }
  Real edge_of(const Cascade& trains, Real scale, Real tolerance, Real inside, Real limit) const {
    const Real step = std::min(0.02L, inside / 8) * scale;
    return edge_towards(trains, zeta_, tolerance, inside * scale, limit * scale, step) / scale;
  }

  void edge(Real outer_zero, Real limit, Checked& out) const {
    // From a little outside the zero, where it may have moved on the ticks.
    const Real tolerance = tolerance_ * (1 + 1e-9L);
    const Real wanted = edge_of(prototype_.train, 1, tolerance, outer_zero, limit);
    if (wanted == limit) return;
    const Real inside = outer_zero + (wanted - outer_zero) / 4;
    const Real run = edge_of(taps_, cycles_, tolerance, inside, limit);
    const Real outward = limit > outer_zero ? 1 : -1;
    const Real miss = two_sided_ ? std::abs(run / wanted - 1) : std::max(0.0L, outward * (1 - run / wanted));
    out.edge = std::max(out.edge, miss);
    if (miss <= kEdgeAsked) return;
    const Real low = edge_of(prototype_.train, 1, tolerance_ * 0.98L, outer_zero, limit);
    const Real high = edge_of(prototype_.train, 1, tolerance_ * 1.02L, outer_zero, limit);
    out.touching = outward * (run - low) >= -kEdgeAsked * low && outward * (run - high) <= kEdgeAsked * high;
  }

  const Prototype& prototype_;
  const Cascade& taps_;
  Real zeta_;
  Real tolerance_;
  Real cycles_;
  bool two_sided_;
};

inline Checked check_design(const ShaperSpec& spec) {
  Checked out;
  ShaperDesign design{};
  PlacementReport report{};
  Prototype prototype{};
  out.refused = !add_shaper(spec, kFamilyTick, design, &report).ok() || !make_prototype(spec, prototype).ok();
  if (out.refused) return out;
  check_gains(design, spec.kind == ShaperKind::kUmZv, report, out);
  out.band_miss = report.band_miss;
  const Cascade taps = impulses_of(design);
  if (has_zero_at_mode(spec.kind))
    out.at_mode = residual_ratio(taps, static_cast<Real>(spec.mode.frequency_hz) * static_cast<Real>(kFamilyTick),
                                 spec.mode.damping_ratio);
  if (!has_band(spec.kind)) return out;
  const BandCheck band(prototype, taps, spec);
  if (humps_of(spec.kind) > 0) band.humps(out);
  band.edges(out);
  return out;
}

// The table of a campaign.
struct FamilyTally {
  struct Row {
    long designs = 0;
    long refused = 0;
    long misses = 0;  // of what is asked
    long silent = 0;  // of them neither reported nor of a touching lobe
    long negative = 0;
    long broken = 0;  // sums, gains, unannounced negative taps, a zero that is none
    Real hump = 0;    // worst of those that do not miss by a touching lobe
    Real edge = 0;
    Real at_mode = 0;
    double gain = 1.0;
  };
  Row rows[kShaperKinds];

  void add(const ShaperSpec& spec, const Checked& checked) {
    Row& row = rows[static_cast<uint32_t>(spec.kind)];
    if (checked.refused) {
      ++row.refused;
      return;
    }
    const bool two_sided = spec.mode.frequency_hz <= kTwoSidedHz;
    const bool hump_missed = two_sided ? checked.hump > kHumpAsked : checked.excess > 1e-6L;
    const bool missed = hump_missed || checked.edge > kEdgeAsked;
    ++row.designs;
    row.misses += missed;
    row.silent += missed && !(checked.band_miss > 1.0) && (hump_missed || !checked.touching);
    row.negative += checked.negative;
    row.broken += !checked.sums_to_one || !checked.gains_fit || checked.unannounced || checked.at_mode > 1e-6L;
    row.at_mode = std::max(row.at_mode, checked.at_mode);
    row.gain = std::max(row.gain, checked.peak_gain);
    row.hump = std::max(row.hump, two_sided ? checked.hump : std::max(0.0L, checked.excess));
    row.edge = std::max(row.edge, checked.edge);
  }

  Row total() const {
    Row sum;
    for (const Row& row : rows) {
      sum.designs += row.designs;
      sum.refused += row.refused;
      sum.misses += row.misses;
      sum.silent += row.silent;
      sum.negative += row.negative;
      sum.broken += row.broken;
    }
    return sum;
  }

  void print(const char* title) const {
    std::printf("%s\n%-8s%9s%9s%8s%8s%10s%10s%10s%10s%8s\n", title, "type", "designs", "refused", "misses", "silent",
                "hump", "edge", "at mode", "negative", "gain");
    for (uint32_t i = 0; i < kShaperKinds; ++i) {
      const Row& row = rows[i];
      if (row.designs == 0) continue;
      std::printf("%-8s%9ld%9ld%8ld%8ld%10.2Le%10.2Le%10.2Le%10ld%8.3f\n", text(static_cast<ShaperKind>(i)),
                  row.designs, row.refused, row.misses, row.silent, row.hump, row.edge, row.at_mode, row.negative,
                  row.gain);
    }
  }
};

// Kinds in turn, frequencies evenly in their logarithm, tolerances too.
inline ShaperSpec random_spec(Random& random, long n, double low_hz, double high_hz) {
  const auto kind = static_cast<ShaperKind>(1 + n % 13);
  const double frequency_hz = low_hz * std::pow(high_hz / low_hz, random.unit());
  const double zeta = random.between(0.0, kMaxDampingRatio);
  const double tolerance = kMinTolerance * std::pow(kMaxTolerance / kMinTolerance, random.unit());
  return ShaperSpec{kind, Mode{frequency_hz, zeta}, tolerance, random.between(kMinSpacing, kMaxSpacing), nullptr};
}

}  // namespace stillpoint::testing

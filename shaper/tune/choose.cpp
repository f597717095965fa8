// SPDX-License-Identifier: Apache-2.0
#include "shaper/tune/choose.hpp"

#include "shaper/base/math.hpp"
#include "shaper/shaping/band_check.hpp"

namespace stillpoint {

namespace {

constexpr double kDeviations = 2.0;
constexpr double kLeastWidth = 1e-4;  // of a band, over the frequency
constexpr double kWeak = 0.25;        // of the tolerance
constexpr double kHumps = 0.9;        // the rest is for damping that differs

constexpr ShaperKind kKinds[] = {ShaperKind::kZv, ShaperKind::kZvd, ShaperKind::kEi, ShaperKind::kZvdd,
                                 ShaperKind::kZvddd};
constexpr uint32_t kKindCount = 5;
// Twice the zeros that each counts for at first sight: an EI of 5 % holds half as wide again as a ZVD.
constexpr uint8_t kHalfZeros[] = {2, 4, 5, 6, 8};

double rounded(double value, double per_one) { return static_cast<uint32_t>(value * per_one + 0.5) / per_one; }

ModeBand band_of(const IdentifiedMode& mode, double tick_s) {
  const double half = math::greater(kDeviations * mode.frequency_std_hz, kLeastWidth * mode.frequency_hz);
  const double damping = kDeviations * mode.damping_std;
  ModeBand band{};
  band.low_hz = math::greater(mode.frequency_hz - half, 0.05 * mode.frequency_hz);
  band.high_hz = math::lesser(mode.frequency_hz + half, 0.499 / tick_s);
  band.low_damping = math::lesser(math::greater(mode.damping_ratio - damping, 0.0), kMaxDampingRatio);
  band.high_damping = math::lesser(mode.damping_ratio + damping, kMaxDampingRatio);
  return band;
}

// A design that grows by a shaper a mode, and how sure it is of each.
class Choice {
 public:
  Choice(double tolerance, double tick_s, const Meanwhile& meanwhile)
      : tolerance_(tolerance), tick_s_(tick_s), meanwhile_(meanwhile) {}

  void add(const IdentifiedMode& mode, double part, TuneProposal& proposal) {
    const ModeBand band = band_of(mode, tick_s_);
    const double others = worst(design_, band);
    if (part * others <= kWeak * tolerance_) return;
    ShaperSpec spec{kKinds[0], Mode{rounded(mode.frequency_hz, 1e4), rounded(mode.damping_ratio, 1e5)}, 0.0, 0.0,
                    nullptr};
    if (spec.mode.damping_ratio > kMaxDampingRatio) spec.mode.damping_ratio = kMaxDampingRatio;
    ShaperDesign zv{};
    if (!add_shaper(spec, tick_s_, zv).ok()) return;
    const double zv_leaves = worst(zv, band);
    double expected = others;
    const double half_zero = math::sqrt(zv_leaves);
    uint32_t counted = 0;
    ShaperDesign best = design_;
    for (uint32_t i = 0; i < kKindCount; ++i) {
      for (; counted < kHalfZeros[i]; ++counted) expected *= half_zero;
      const bool is_last = i + 1 == kKindCount;
      if (expected > tolerance_ && !is_last) continue;
      spec.kind = kKinds[i];
      spec.tolerance = spec.kind == ShaperKind::kEi ? kHumps * tolerance_ : 0.0;
      ShaperDesign trial = design_;
      if (!add_shaper(spec, tick_s_, trial, nullptr, meanwhile_).ok()) continue;
      best = trial;
      proposal.specs[proposal.spec_count] = spec;
      if (worst(trial, band) <= tolerance_) break;
    }
    if (best.stage_count == design_.stage_count) return;
    design_ = best;
    ++proposal.spec_count;
  }

  double leaves(const IdentifiedMode& mode) const { return worst(design_, band_of(mode, tick_s_)); }
  const ShaperDesign& design() const { return design_; }

 private:
  double worst(const ShaperDesign& design, const ModeBand& band) const {
    meanwhile_();
    if (design.stage_count == 0 || !band.validate(tick_s_).ok()) return 1.0;
    return worst_residual(design.cascade(), band, tick_s_).residual;
  }

  double tolerance_;
  double tick_s_;
  const Meanwhile& meanwhile_;
  ShaperDesign design_{};
};

}  // namespace

void choose(const Identification& found, double tolerance, double tick_s, TuneProposal& proposal,
            const Meanwhile& meanwhile) {
  proposal = TuneProposal{};
  double sum = 0.0;
  for (size_t k = 0; k < found.mode_count; ++k) sum += found.mode[k].amplitude;
  if (!(sum > 0.0)) return;
  Choice choice(tolerance, tick_s, meanwhile);
  for (size_t k = 0; k < found.mode_count; ++k) choice.add(found.mode[k], found.mode[k].amplitude / sum, proposal);
  proposal.delay_s = choice.design().delay_ticks() * tick_s;
  proposal.length_s = choice.design().length_ticks() * tick_s;
  for (size_t k = 0; k < found.mode_count; ++k)
    proposal.residual = math::greater(proposal.residual, choice.leaves(found.mode[k]) * found.mode[k].amplitude / sum);
}

Status design_of(const TuneProposal& proposal, double tick_s, ShaperDesign& design, const Meanwhile& meanwhile) {
  Status status = kOk;
  for (uint32_t i = 0; i < proposal.spec_count && status.ok(); ++i)
    status = add_shaper(proposal.specs[i], tick_s, design, nullptr, meanwhile);
  return status;
}

}  // namespace stillpoint

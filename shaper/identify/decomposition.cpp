// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/decomposition.hpp"

namespace stillpoint {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kMostAttempts = 8;

// Bins about a component: the noise beside it, and what lies under its own peak.
constexpr double kBeside = 16.0;
constexpr double kUnder = 4.0;
// The mean of the nine bins under a peak passes this many times the noise in one of 1000 records of white noise.
constexpr double kStructured = 2.2;

struct Spectrum {
  const double* power;
  size_t size;
  size_t count;

  double mean(double bin, double reach, size_t& bins) const {
    const double scale = static_cast<double>(size) / static_cast<double>(count);
    const double low = (bin - reach) * scale;
    const double high = (bin + reach) * scale;
    double sum = 0.0;
    bins = 0;
    for (size_t k = low > 1.0 ? static_cast<size_t>(math::ceil(low)) : 1; k < size / 2; ++k) {
      if (static_cast<double>(k) > high) break;
      sum += power[k];
      ++bins;
    }
    return bins == 0 ? 0.0 : sum / (static_cast<double>(bins) * static_cast<double>(count));
  }
};

double energy_of(const Component& component, size_t count) {
  const double square = math::square(component.cosine) + math::square(component.sine);
  const double twice = 2.0 * component.decay;
  const double mean = math::magnitude(twice) < 1e-6 ? 1.0 : (1.0 - math::exp(-twice)) / twice;
  return 0.5 * square * static_cast<double>(count) * mean;
}

ComponentDoubt doubt_of(const Spectrum& left, const DecayFit& fit, const DecayModel& model, size_t k) {
  const Component& component = model.component[k];
  const double bin = component.angle / (2.0 * kPi);
  const double width = math::magnitude(component.decay) / (2.0 * kPi);
  size_t bins = 0, bins_under = 0;
  const double beside = left.mean(bin, kBeside + width, bins);
  const double under = left.mean(bin, kUnder + width, bins_under);
  const bool structured = under > kStructured * beside;
  // The fit has taken two of the 2 `bins` degrees for amplitudes and two for decay and angle.
  const double taken = bins > 4 ? static_cast<double>(bins) / static_cast<double>(bins - 2) : 2.0;
  const double variance = structured ? under : taken * beside;
  const double own = energy_of(component, left.count);
  const ComponentCovariance covariance = fit.covariance(model, k);
  ComponentDoubt doubt{};
  doubt.decay = variance * covariance.decay;
  doubt.angle = variance * covariance.angle;
  doubt.decay_angle = variance * covariance.decay_angle;
  doubt.evidence = variance > 0.0 ? covariance.evidence / variance : covariance.evidence > 0.0 ? 1e300 : 0.0;
  doubt.noise = variance;
  doubt.structure = structured && own > 0.0 ? 2.0 * static_cast<double>(bins_under) * (under - beside) / own : 0.0;
  return doubt;
}

// Two modes nearer than this are one that does not decay as a mode does.
bool are_apart(const Component& a, const Component& b) {
  const double widths = 2.0 * (math::magnitude(a.decay) + math::magnitude(b.decay));
  const double least = 4.0 * kPi;
  return math::magnitude(a.angle - b.angle) > 0.8 * (widths > least ? widths : least);
}

bool are_all_apart(const DecayModel& model) {
  for (size_t k = 0; k < model.count; ++k) {
    for (size_t other = 0; other < k; ++other) {
      if (!are_apart(model.component[k], model.component[other])) return false;
    }
  }
  return true;
}

class Builder {
 public:
  Builder(const Record& record, IdentifyScratch& scratch, const Meanwhile& meanwhile)
      : record_(record), scratch_(scratch), meanwhile_(meanwhile) {
    size_ = fft_size_for(record.count);
  }

  Decomposition build() {
    scratch_.fit.solve_linear(record_, result_.model, nullptr, meanwhile_);
    while (result_.model.count < kMostComponents && has_room() && !meanwhile_.is_given_up()) {
      const Candidates found = find_candidates(record_, result_.model, refused_, scratch_.buffer, size_, meanwhile_);
      if (found.standing.score < kWorthTrying) {
        if (found.standing.score > result_.best_score) result_.best_score = found.standing.score;
        break;
      }
      if (!try_adding(found.largest) && !try_adding(found.standing)) {
        if (found.standing.score > result_.best_score) result_.best_score = found.standing.score;
        if (attempts_ >= kMostAttempts || refused_.count >= Refused::kMost) break;
      }
    }
    if (meanwhile_.is_given_up()) return result_;
    scratch_.fit.solve_linear(record_, result_.model, nullptr, meanwhile_);
    judge(result_.model, result_.doubt);
    result_.variance =
        scratch_.fit.residual_energy() / static_cast<double>(record_.count - (4 * result_.model.count + 2));
    return result_;
  }

 private:
  bool has_room() const { return record_.count > 8 * (result_.model.count + 1) + 2; }

  void judge(const DecayModel& model, ComponentDoubt* doubt) {
    residual_spectrum(record_, model, scratch_.buffer, size_);
    const Spectrum left{scratch_.buffer, size_, record_.count};
    for (size_t k = 0; k < model.count; ++k) doubt[k] = doubt_of(left, scratch_.fit, model, k);
  }

  // What was refused before may fit once another is in.
  bool try_adding(const ModeCandidate& candidate) {
    if (attempts_ >= kMostAttempts || is_tried(candidate.angle)) return false;
    ++attempts_;
    DecayModel trial = result_.model;
    trial.component[trial.count++] = Component{candidate.decay, candidate.angle, 0.0, 0.0};
    if (!scratch_.fit.refine(record_, trial, nullptr, meanwhile_) || !are_all_apart(trial) || !stands_out(trial)) {
      refused_.add(candidate.angle);
      return false;
    }
    result_.model = trial;
    refused_ = Refused{};
    return true;
  }

  bool is_tried(double angle) const {
    for (size_t i = 0; i < refused_.count; ++i) {
      if (refused_.angle[i] == angle) return true;
    }
    return false;
  }

  // Every component against the noise under the peaks: the modes that are not in the model yet do not count.
  bool stands_out(const DecayModel& trial) {
    residual_spectrum(record_, trial, scratch_.buffer, size_);
    NoiseFloor floor{};
    floor.take(scratch_.buffer, size_, record_);
    const double to_bin = static_cast<double>(size_) / (2.0 * kPi * static_cast<double>(record_.count));
    for (size_t k = 0; k < trial.count; ++k) {
      const double noise = floor.at(static_cast<size_t>(to_bin * trial.component[k].angle));
      if (!(scratch_.fit.covariance(trial, k).evidence > kLeastEvidence * noise)) return false;
    }
    return true;
  }

  const Record& record_;
  IdentifyScratch& scratch_;
  const Meanwhile& meanwhile_;
  size_t size_ = 0;
  Decomposition result_{};
  int attempts_ = 0;
  Refused refused_{};
};

}  // namespace

Decomposition decompose(const Record& record, IdentifyScratch& scratch, const Meanwhile& meanwhile) {
  return Builder(record, scratch, meanwhile).build();
}

}  // namespace stillpoint

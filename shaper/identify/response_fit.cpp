// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/response_fit.hpp"

#include "shaper/base/math.hpp"
#include "shaper/identify/response_projection.hpp"

namespace stillpoint {

namespace {

constexpr double kPi = 3.14159265358979323846;

// Of chi^2 with four degrees, the best of all candidates: noise passes the second once in a million sets.
constexpr double kNoisyEvidence = 25.0;
constexpr double kLeastEvidence = 40.0;

// Where what is left shows that the spreads are not to be believed, a few answers may rule: all modes together must
// then take away that many times what they leave.
constexpr double kNotBelieved = 9.0;
constexpr double kLeastPart = 10.0;
constexpr double kLeastPartOfTwo = 100.0;  // where one alone takes next to nothing

constexpr double kTold = 0.05;  // a mode's frequency, and half of its damping

[[gnu::noinline]] double trust(double doubt, double half) { return 1.0 / (1.0 + math::square(doubt / half)); }

// Looks for one mode after the other, and says which are told.
class ResponseFit {
 public:
  ResponseFit(const BinAnswer* answers, size_t count, const ResponseConfig& config, ResponseScratch& scratch,
              const Meanwhile& meanwhile)
      : projection_(answers, count, config, scratch, meanwhile), answers_(answers), count_(count), config_(config) {}

  void run(Identification& result) {
    if (!projection_.heard()) return;
    ResponseModel model{};
    model.turn = 2.0 * kPi * projection_.top_hz() * config_.delay_s;
    ResponseModel start = model;
    const double rigid = projection_.refine(model);
    double left = rigid;
    double evidence = 0.0;
    bool looks_ahead = false;
    while (start.count < config_.most_modes && count_ >= kLeastAnswers + 4 * start.count) {
      start = search(start);
      ResponseModel trial = start;
      const double then = projection_.refine(trial);
      evidence = (left - then) / variance(then, trial);
      const bool enough = !looks_ahead || left - then > kLeastPartOfTwo * then;
      const bool taken = evidence > kLeastEvidence && enough && are_apart(trial);
      // Alone it may explain little of what it does with the next.
      if (!taken && (looks_ahead || then <= kNotBelieved * projection_.freedom(trial))) break;
      looks_ahead = !taken;
      start = trial;
      if (!taken) continue;
      model = trial;
      left = then;
    }
    projection_.refine(model);
    if (left > kNotBelieved * projection_.freedom(model) && rigid - left < kLeastPart * left) model.count = 0;
    report(model, left, evidence, result);
  }

 private:
  // Of the answers, by what is left and by their own spreads, the larger.
  double variance(double left, const ResponseModel& model) const {
    return math::greater(left / projection_.freedom(model), 1.0);
  }

  // The mode that takes most away, on the bins and between, narrow to wide.
  ResponseModel search(const ResponseModel& model) {
    static constexpr double kDampings[] = {0.02, 0.08, 0.3};
    ResponseModel best = model;
    ResponseModel trial = model;
    const size_t at = 2 * trial.count++;
    double least = math::kInfinity;
    for (size_t i = 0; i + 1 < 2 * count_; ++i) {
      const double sum = answers_[i / 2].frequency_hz + answers_[(i + 1) / 2].frequency_hz;
      trial.parameter[at] = 0.5 * sum / projection_.top_hz();
      for (size_t k = 0; k < 3; ++k) {
        trial.parameter[at + 1] = kDampings[k];
        const double left = projection_.left_by(trial);
        if (left < least) {
          least = left;
          best = trial;
        }
      }
    }
    return best;
  }

  // By a bin, and by as much as they are wide.
  bool are_apart(const ResponseModel& model) const {
    const double bin = math::log(projection_.top_hz() / answers_[0].frequency_hz) / static_cast<double>(count_ - 1);
    for (size_t k = 2; k < 2 * model.count; k += 2) {
      for (size_t i = 0; i < k; i += 2) {
        const double width = model.parameter[k + 1] + model.parameter[i + 1];
        if (math::magnitude(math::log(model.parameter[k] / model.parameter[i])) < math::greater(bin, width))
          return false;
      }
    }
    return true;
  }

  void report(const ResponseModel& model, double left, double evidence, Identification& result) {
    const double noise = variance(left, model);
    result.noise = math::sqrt(left / projection_.freedom(model));
    bool unclear = model.count == 0 && evidence > kNoisyEvidence;
    for (size_t k = 0; k < model.count; ++k) {
      const double damping = model.parameter[2 * k + 1];
      if (!(damping < kMostResponseDamping)) continue;  // a servo's bandwidth, if anything
      const double of_frequency = projection_.deviation(2 * k, noise);
      const double of_damping = projection_.deviation(2 * k + 1, noise);
      if (!(of_frequency < kTold && of_damping < 10.0 * kTold)) {
        unclear = true;
        continue;
      }
      IdentifiedMode mode{};
      mode.frequency_hz = projection_.top_hz() * model.parameter[2 * k];
      mode.damping_ratio = damping;
      mode.amplitude =
          math::sqrt(square_of(model.factor[kRigidColumns + k])) * projection_.power_of(model.parameter[2 * k]);
      mode.frequency_std_hz = of_frequency * mode.frequency_hz;
      mode.damping_std = of_damping * damping;
      mode.viscous = true;
      mode.confidence = trust(of_frequency, 0.02) * trust(of_damping, 0.5);
      size_t place = result.mode_count++;
      for (; place > 0 && result.mode[place - 1].amplitude < mode.amplitude; --place)
        result.mode[place] = result.mode[place - 1];
      result.mode[place] = mode;
    }
    result.finding = result.mode_count > 0 ? Finding::kFound : unclear ? Finding::kNoisy : Finding::kNoMode;
    result.confidence = result.mode[0].confidence;
  }

  ResponseProjection projection_;
  const BinAnswer* answers_;
  size_t count_;
  const ResponseConfig& config_;
};

Status check(const BinAnswer* answers, size_t count) {
  double before = 0.0;
  for (size_t n = 0; n < count; ++n) {
    const BinAnswer& answer = answers[n];
    Status status = check_finite(Quantity::kFrequency, answer.frequency_hz);
    if (status.ok()) status = check_finite(Quantity::kSamples, answer.re + answer.im + answer.spread);
    if (!status.ok()) return status;
    if (!(answer.frequency_hz > before))
      return refuse(Error::kBelowMinimum, Quantity::kFrequency, answer.frequency_hz, before);
    if (answer.spread < 0.0) return refuse(Error::kBelowMinimum, Quantity::kSamples, answer.spread, 0.0);
    before = answer.frequency_hz;
  }
  return kOk;
}

}  // namespace

Status ResponseConfig::validate() const {
  Status status = check_count(Quantity::kKind, power, 0, 2);
  if (status.ok()) status = check_count(Quantity::kStages, most_modes, 1, kMostResponseModes);
  if (!status.ok()) return status;
  if (delay_s < 0.0) return refuse(Error::kBelowMinimum, Quantity::kDelay, delay_s, 0.0);
  return check_finite(Quantity::kDelay, delay_s);
}

Status identify_response(const BinAnswer* answers, size_t count, const ResponseConfig& config, ResponseScratch& scratch,
                         Identification& result, const Meanwhile& meanwhile) {
  Status status = config.validate();
  if (status.ok()) status = check(answers, count);
  if (!status.ok()) return status;
  result = Identification{};
  if (count < kLeastAnswers) {
    result.finding = Finding::kTooShort;
    return kOk;
  }
  result.finding = Finding::kNoMode;
  ResponseFit(answers, count, config, scratch, meanwhile).run(result);
  return kOk;
}

}  // namespace stillpoint

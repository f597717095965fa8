// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/response_fit.hpp"

namespace stillpoint {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr size_t kRigid = 3;  // columns of what does not resonate
constexpr int kMostPasses = 40;

// Of chi^2 with four degrees, the best of all candidates: noise passes the second once in a million sets.
constexpr double kNoisyEvidence = 25.0;
constexpr double kLeastEvidence = 40.0;

// Where what is left shows that the spreads are not to be believed, a few answers may rule: all modes together must
// then take away that many times what they leave.
constexpr double kNotBelieved = 9.0;
constexpr double kLeastPart = 10.0;
constexpr double kLeastPartOfTwo = 100.0;  // where one alone takes next to nothing

constexpr double kWider = 1.2;  // modes are looked for beyond the band
constexpr double kLeastDamping = 0.001;
constexpr double kMostDamping = 0.6;
constexpr double kTold = 0.05;  // a mode's frequency, and half of its damping

// What a spread is at least: of the median, of the answer itself and of the largest.
constexpr double kOfMedian = 0.25;
constexpr double kOfAnswer = 1e-3;
constexpr double kOfLargest = 1e-7;

[[gnu::noinline]] double bounded(double value, double low, double high) {
  return value < low ? low : value > high ? high : value;
}
[[gnu::noinline]] double size_of(const BinAnswer& answer) {
  return math::greater(math::magnitude(answer.re), math::magnitude(answer.im));
}
[[gnu::noinline]] double trust(double doubt, double half) { return 1.0 / (1.0 + math::square(doubt / half)); }

// Frequencies in units of the highest answer's.
struct ResponseModel {
  size_t count;
  double turn;                               // of the delay, radians at the highest answer
  double parameter[2 * kMostResponseModes];  // frequency, damping, frequency, ...
  Complex factor[kRigid + kMostResponseModes];
};

class ResponseFit {
 public:
  ResponseFit(const BinAnswer* answers, size_t count, const ResponseConfig& config, ResponseScratch& scratch,
              const Meanwhile& meanwhile)
      : answers_(answers), count_(count), config_(config), scratch_(scratch), meanwhile_(meanwhile) {
    top_ = answers[count - 1].frequency_hz;
    double largest = 0.0;
    for (size_t n = 0; n < count; ++n) largest = math::greater(largest, size_of(answers[n]));
    const double median = median_spread();
    floor_ = math::greater(kOfMedian * median, kOfLargest * largest);
  }

  void run(Identification& result) {
    if (!(floor_ > 0.0)) return;  // nothing but zeros
    ResponseModel model{};
    model.turn = 2.0 * kPi * top_ * config_.delay_s;
    ResponseModel start = model;
    const double rigid = refine(model);
    double left = rigid;
    double evidence = 0.0;
    bool looks_ahead = false;
    while (start.count < config_.most_modes && count_ >= kLeastAnswers + 4 * start.count) {
      start = search(start);
      ResponseModel trial = start;
      const double then = refine(trial);
      evidence = (left - then) / variance(then, trial);
      const bool enough = !looks_ahead || left - then > kLeastPartOfTwo * then;
      const bool taken = evidence > kLeastEvidence && enough && are_apart(trial);
      // Alone it may explain little of what it does with the next.
      if (!taken && (looks_ahead || then <= kNotBelieved * freedom(trial))) break;
      looks_ahead = !taken;
      start = trial;
      if (!taken) continue;
      model = trial;
      left = then;
    }
    refine(model);
    if (left > kNotBelieved * freedom(model) && rigid - left < kLeastPart * left) model.count = 0;
    report(model, left, evidence, result);
  }

 private:
  [[gnu::noinline]] Complex& at(size_t row, size_t column) {
    return scratch_.triangle[column * (column + 1) / 2 + row];
  }

  double median_spread() const {
    double median = 0.0;
    for (size_t n = 0; n < count_; ++n) {
      size_t below = 0;
      for (size_t k = 0; k < count_; ++k) below += answers_[k].spread < answers_[n].spread ? 1 : 0;
      if (2 * below <= count_) median = math::greater(median, answers_[n].spread);
    }
    return median;
  }

  [[gnu::noinline]] double power_of(double x) const {
    double power = 1.0;
    for (uint32_t i = 0; i < config_.power; ++i) power *= x;
    return power;
  }

  // A row of the matrix comes into the triangle by Givens rotations; diagonals stay real.
  void push(Complex* row) {
    for (size_t j = 0; j < columns_; ++j) {
      const double below = square_of(row[j]);
      if (below == 0.0) continue;
      Complex& diagonal = at(j, j);
      const double length = math::sqrt(math::square(diagonal.re) + below);
      const double c = diagonal.re / length;
      const Complex s = (1.0 / length) * row[j];
      diagonal.re = length;
      for (size_t k = j + 1; k < columns_; ++k) {
        const Complex above = at(j, k);
        at(j, k) = c * above + conjugate(s) * row[k];
        row[k] = c * row[k] - s * above;
      }
    }
  }

  // Columns: what does not resonate, the modes; with `slopes`, their derivatives by the logarithms of frequency and
  // damping, and the answers' by the delay; the answers. These are turned back by the delay, not the model by it.
  void write_row(const BinAnswer& answer, const ResponseModel& model, bool slopes, Complex* row) const {
    const double x = answer.frequency_hz / top_;
    const double weight = 1.0 / math::greater(math::greater(answer.spread, floor_), kOfAnswer * size_of(answer));
    const double unit = weight * power_of(x);
    const double xx = x * x;
    row[0] = {unit, 0.0};
    row[1] = {unit * xx, 0.0};
    row[2] = {unit * xx * xx, 0.0};
    Complex* slope = row + kRigid + model.count;
    for (size_t k = 0; k < model.count; ++k) {
      const double from = x / model.parameter[2 * k];
      const double square = from * from;
      const double lag = 2.0 * model.parameter[2 * k + 1] * from;
      const Complex one = Complex{1.0, 0.0} / Complex{1.0 - square, lag};
      row[kRigid + k] = unit * one;
      if (!slopes) continue;
      const Complex twice = row[kRigid + k] * one;
      *slope++ = Complex{-2.0 * square, lag} * twice;
      *slope++ = Complex{0.0, -lag} * twice;
    }
    const Complex turned = weight * (Complex{answer.re, answer.im} * math::exp(Complex{0.0, model.turn * x}));
    if (slopes) *slope++ = Complex{0.0, x} * turned;
    *slope = turned;
  }

  // The weighted sum of squares that is left with the best factors.
  double pass(const ResponseModel& model, bool slopes) {
    meanwhile_();
    const size_t linear = kRigid + model.count;
    columns_ = linear + (slopes ? 2 * model.count + 1 : 0) + 1;
    for (size_t i = 0; i < columns_ * (columns_ + 1) / 2; ++i) scratch_.triangle[i] = {0.0, 0.0};
    Complex row[ResponseScratch::kColumns];
    for (size_t n = 0; n < count_; ++n) {
      write_row(answers_[n], model, slopes, row);
      push(row);
    }
    double left = 0.0;
    for (size_t i = linear; i < columns_; ++i) left += square_of(at(i, columns_ - 1));
    return left;
  }

  void take_factors(ResponseModel& model) {
    for (size_t i = kRigid + model.count; i-- > 0;) {
      Complex sum = at(i, columns_ - 1);
      for (size_t k = i + 1; k < kRigid + model.count; ++k) sum = sum - at(i, k) * model.factor[k];
      const double diagonal = at(i, i).re;
      model.factor[i] = (diagonal > 0.0 ? 1.0 / diagonal : 0.0) * sum;
    }
  }

  // The linearised problem in logarithms and the delay.
  void take_normal(const ResponseModel& model) {
    const size_t linear = kRigid + model.count;
    const size_t size = 2 * model.count + 1;
    LinearSystem<ResponseScratch::kParameters>& normal = scratch_.normal;
    normal.clear(size);
    for (size_t i = 0; i < size; ++i) {
      Complex slope[ResponseScratch::kParameters + 1];
      for (size_t k = i; k < size; ++k) {
        const Complex factor = k + 1 == size ? Complex{-1.0, 0.0} : model.factor[kRigid + k / 2];
        slope[k] = factor * at(linear + i, linear + k);
      }
      slope[size] = at(linear + i, columns_ - 1);
      for (size_t j = i; j < size; ++j) {
        for (size_t k = i; k <= size; ++k) {
          const double product = (conjugate(slope[j]) * slope[k]).re;
          (k < size ? normal.row[j][k] : normal.right(j)) += product;
        }
      }
    }
  }

  // Returns how far the sum of squares would fall; below 0 where nothing can be told.
  double step(double damping, double* change) {
    LinearSystem<ResponseScratch::kParameters> damped = scratch_.normal;
    for (size_t i = 0; i < damped.size; ++i) damped.row[i][i] *= 1.0 + damping;
    if (!damped.solve(change)) return -1.0;
    double gain = 0.0;
    for (size_t i = 0; i < damped.size; ++i) gain += change[i] * scratch_.normal.right(i);
    return gain;
  }

  ResponseModel moved(const ResponseModel& from, const double* change) const {
    constexpr double kFurthest = 0.7;
    ResponseModel model = from;
    for (size_t k = 0; k < 2 * model.count; ++k) {
      const bool is_damping = k % 2 == 1;
      const double reach = is_damping ? kFurthest : 0.2 * kFurthest;
      model.parameter[k] = bounded(model.parameter[k] * math::exp(bounded(change[k], -reach, reach)),
                                   is_damping ? kLeastDamping : answers_[0].frequency_hz / (kWider * top_),
                                   is_damping ? kMostDamping : kWider);
    }
    model.turn += bounded(change[2 * model.count], -kFurthest, kFurthest);
    return model;
  }

  // To the nearest least sum of squares, which it returns; leaves factors and the linearised problem there.
  double refine(ResponseModel& model) {
    constexpr double kDone = 1e-4;  // of a standard deviation, squared
    double left = pass(model, true);
    take_factors(model);
    take_normal(model);
    double damping = 1e-3;
    for (int passes = 1; passes < kMostPasses && damping < 1e6; ++passes) {
      double change[ResponseScratch::kParameters];
      const double gain = step(damping, change);
      if (gain >= 0.0 && damping <= 1.0 && gain <= kDone * left / freedom(model)) break;
      ResponseModel trial = model;
      double then = left;
      if (gain > 0.0) {
        trial = moved(model, change);
        then = pass(trial, true);
      }
      if (then < left) {
        left = then;
        model = trial;
        take_factors(model);
        take_normal(model);
        damping *= 0.1;
      } else {
        damping *= damping < 1e-3 ? 100.0 : 10.0;
      }
    }
    return left;
  }

  [[gnu::noinline]] double freedom(const ResponseModel& model) const {
    return static_cast<double>(2 * count_ - (2 * kRigid + 1 + 4 * model.count));
  }

  // Of the answers, by what is left and by their own spreads, the larger.
  double variance(double left, const ResponseModel& model) const { return math::greater(left / freedom(model), 1.0); }

  // The mode that takes most away, on the bins and between, narrow to wide.
  ResponseModel search(const ResponseModel& model) {
    static constexpr double kDampings[] = {0.02, 0.08, 0.3};
    ResponseModel best = model;
    ResponseModel trial = model;
    const size_t at = 2 * trial.count++;
    double least = math::kInfinity;
    for (size_t i = 0; i + 1 < 2 * count_; ++i) {
      const double sum = answers_[i / 2].frequency_hz + answers_[(i + 1) / 2].frequency_hz;
      trial.parameter[at] = 0.5 * sum / top_;
      for (size_t k = 0; k < 3; ++k) {
        trial.parameter[at + 1] = kDampings[k];
        const double left = pass(trial, false);
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
    const double bin = math::log(top_ / answers_[0].frequency_hz) / static_cast<double>(count_ - 1);
    for (size_t k = 2; k < 2 * model.count; k += 2) {
      for (size_t i = 0; i < k; i += 2) {
        const double width = model.parameter[k + 1] + model.parameter[i + 1];
        if (math::magnitude(math::log(model.parameter[k] / model.parameter[i])) < math::greater(bin, width))
          return false;
      }
    }
    return true;
  }

  double deviation(size_t parameter, double noise) {
    LinearSystem<ResponseScratch::kParameters> system = scratch_.normal;
    for (size_t i = 0; i < system.size; ++i) system.right(i) = i == parameter ? 1.0 : 0.0;
    double column[ResponseScratch::kParameters];
    if (!system.solve(column) || !(column[parameter] > 0.0)) return math::kInfinity;
    return math::sqrt(noise * column[parameter]);
  }

  void report(const ResponseModel& model, double left, double evidence, Identification& result) {
    const double noise = variance(left, model);
    result.noise = math::sqrt(left / freedom(model));
    bool unclear = model.count == 0 && evidence > kNoisyEvidence;
    for (size_t k = 0; k < model.count; ++k) {
      const double damping = model.parameter[2 * k + 1];
      if (!(damping < kMostDamping)) continue;  // a servo's bandwidth, if anything
      const double of_frequency = deviation(2 * k, noise);
      const double of_damping = deviation(2 * k + 1, noise);
      if (!(of_frequency < kTold && of_damping < 10.0 * kTold)) {
        unclear = true;
        continue;
      }
      IdentifiedMode mode{};
      mode.frequency_hz = top_ * model.parameter[2 * k];
      mode.damping_ratio = damping;
      mode.amplitude = math::sqrt(square_of(model.factor[kRigid + k])) * power_of(model.parameter[2 * k]);
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

  const BinAnswer* answers_;
  size_t count_;
  const ResponseConfig& config_;
  ResponseScratch& scratch_;
  const Meanwhile& meanwhile_;
  size_t columns_ = 0;
  double top_;
  double floor_;
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

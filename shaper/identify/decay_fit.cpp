// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/decay_fit.hpp"

namespace stillpoint {

namespace {

constexpr double kPi = 3.14159265358979323846;

// Columns: offset, drift, then cosine and sine of each component, then their derivatives, then the record.
constexpr size_t basis_column(size_t k) { return 2 + 2 * k; }
constexpr size_t derivative_column(size_t components, size_t k) { return 2 + 2 * components + 2 * k; }

double bounded(double value, double low, double high) { return value < low ? low : value > high ? high : value; }

// As far as the linearisation may be trusted: a third of a period over the record, or a part of a fast decay.
double furthest(const Component& component) {
  const double decay = math::magnitude(component.decay);
  return decay > 4.0 ? 0.5 * decay : 2.0;
}

DecayModel moved(const DecayModel& from, const double* change, size_t samples) {
  DecayModel model = from;
  for (size_t k = 0; k < model.count; ++k) {
    Component& component = model.component[k];
    const double limit = furthest(component);
    component.angle += bounded(change[2 * k + 1], -limit, limit);
    component.angle = bounded(component.angle, kPi, kPi * static_cast<double>(samples - 1));
    component.decay += bounded(change[2 * k], -limit, limit);
    component.decay = bounded(component.decay, -1.0, component.angle);
  }
  return model;
}

}  // namespace

void DecayFit::pass(const Record& record, const DecayModel& model, const DecayModel* others,
                    const Meanwhile& meanwhile) {
  const size_t components = model.count;
  const double step = 1.0 / static_cast<double>(record.count);
  triangle_.begin(4 * components + 3);
  DecayModel nothing{};
  ModelSamples known(others != nullptr ? *others : nothing, record.count);
  Rotor rotor[kMostComponents];
  for (size_t k = 0; k < components; ++k) {
    rotor[k] = Rotor({-model.component[k].decay * step, model.component[k].angle * step});
  }
  for (size_t n = 0; n < record.count && !meanwhile.is_given_up(); ++n) {
    const double x = static_cast<double>(n) * step;
    triangle_.next(0) = 1.0;
    triangle_.next(1) = x - 0.5;
    for (size_t k = 0; k < components; ++k) {
      const Complex turn = rotor[k].value();
      triangle_.next(basis_column(k)) = turn.re;
      triangle_.next(basis_column(k) + 1) = turn.im;
      triangle_.next(derivative_column(components, k)) = x * turn.re;
      triangle_.next(derivative_column(components, k) + 1) = x * turn.im;
      rotor[k].advance();
    }
    triangle_.next(4 * components + 2) = static_cast<double>(record.samples[n]) - known.next();
    triangle_.push();
    if (n % 128 == 127) meanwhile();
  }
  triangle_.absorb();
}

void DecayFit::take_amplitudes(DecayModel& model) const {
  double solution[2 + 2 * kMostComponents];
  triangle_.solve(basis_column(model.count), solution);
  model.offset = solution[0];
  model.drift = solution[1];
  for (size_t k = 0; k < model.count; ++k) {
    model.component[k].cosine = solution[basis_column(k)];
    model.component[k].sine = solution[basis_column(k) + 1];
  }
}

double DecayFit::fitted_energy() const {
  const size_t last = triangle_.columns - 1;
  double sum = 0.0;
  for (size_t i = (triangle_.columns + 1) / 2; i <= last; ++i) sum += math::square(triangle_.row[i][last]);
  return sum;
}

void DecayFit::Step::take(const DecayFit& fit, const DecayModel& model) {
  size = 2 * model.count;
  const size_t first = derivative_column(model.count, 0);
  for (size_t i = 0; i < size; ++i) {
    const double* from = fit.triangle_.row[first + i];
    for (size_t k = 0; k < model.count; ++k) {
      const Component& component = model.component[k];
      const double in_cosine = from[first + 2 * k];
      const double in_sine = from[first + 2 * k + 1];
      row[i][2 * k] = -component.cosine * in_cosine - component.sine * in_sine;
      row[i][2 * k + 1] = component.sine * in_cosine - component.cosine * in_sine;
    }
    right[i] = from[fit.triangle_.columns - 1];
  }
}

double DecayFit::Step::gain() const {
  double sum = 0.0;
  for (size_t i = 0; i < size; ++i) sum += right[i] * right[i];
  return sum;
}

void DecayFit::Step::solve(double damping, double* change) const {
  Triangle<kParameters + 1, 2 * kParameters> least;
  least.begin(size + 1);
  const double root = math::sqrt(damping);
  for (size_t i = 0; i < size; ++i) {
    for (size_t k = 0; k < size; ++k) least.next(k) = row[i][k];
    least.next(size) = right[i];
    least.push();
  }
  for (size_t i = 0; i < size; ++i) {
    double length = 0.0;
    for (size_t k = 0; k < size; ++k) length += row[k][i] * row[k][i];
    for (size_t k = 0; k < size; ++k) least.next(k) = k == i ? root * math::sqrt(length) : 0.0;
    least.next(size) = 0.0;
    least.push();
  }
  least.absorb();
  least.solve(size, change);
}

void DecayFit::solve_linear(const Record& record, DecayModel& model, const DecayModel* others,
                            const Meanwhile& meanwhile) {
  pass(record, model, others, meanwhile);
  take_amplitudes(model);
}

bool DecayFit::refine(const Record& record, DecayModel& model, const DecayModel* others, const Meanwhile& meanwhile) {
  constexpr double kDone = 1e-4;    // of the noise's variance: a hundredth of a standard deviation
  constexpr double kExact = 1e-24;  // of the record's energy, where there is no noise
  const double freedom = static_cast<double>(record.count - (4 * model.count + 2));
  solve_linear(record, model, others, meanwhile);
  double energy = fitted_energy();
  double left = residual_energy();
  double damping = 1e-3;
  Step step;
  step.take(*this, model);
  for (int passes = 1; passes < kMostPasses; ++passes) {
    if (meanwhile.is_given_up()) return false;
    if (step.gain() <= kDone * left / freedom || step.gain() <= kExact * energy) return true;
    double change[kParameters];
    step.solve(damping, change);
    DecayModel trial = moved(model, change, record.count);
    solve_linear(record, trial, others, meanwhile);
    if (fitted_energy() < energy) {
      energy = fitted_energy();
      left = residual_energy();
      model = trial;
      step.take(*this, model);
      damping *= 0.1;
      continue;
    }
    damping = damping < 1e-3 ? 1e-2 : 10.0 * damping;
    // No way down that doubles can see: this is the bottom.
    if (damping > 1e8) {
      solve_linear(record, model, others, meanwhile);
      return step.gain() <= 1e-2 * energy;
    }
  }
  solve_linear(record, model, others, meanwhile);
  return false;
}

ComponentCovariance DecayFit::covariance(const DecayModel& model, size_t k) const {
  constexpr double kNever = 1e300;
  const size_t size = triangle_.columns - 1;
  const Component& component = model.component[k];
  const double square = math::square(component.cosine) + math::square(component.sine);
  ComponentCovariance covariance{kNever, kNever, 0.0, 0.0};
  double first[4 * kMostComponents + 2];
  double second[4 * kMostComponents + 2];
  const auto pair = [&](size_t row) {
    for (size_t i = 0; i <= row; ++i) first[i] = second[i] = 0.0;
    return triangle_.inverse_row(row, size, first) && triangle_.inverse_row(row + 1, size, second);
  };
  if (!(square > 0.0) || !pair(derivative_column(model.count, k))) return covariance;
  covariance.decay = covariance.angle = 0.0;
  for (size_t i = derivative_column(model.count, k); i < size; ++i) {
    const double decay = (-component.cosine * first[i] - component.sine * second[i]) / square;
    const double angle = (component.sine * first[i] - component.cosine * second[i]) / square;
    covariance.decay += decay * decay;
    covariance.angle += angle * angle;
    covariance.decay_angle += decay * angle;
  }
  if (!pair(basis_column(k))) return covariance;
  double aa = 0.0, ab = 0.0, bb = 0.0;
  for (size_t i = basis_column(k); i < size; ++i) {
    aa += first[i] * first[i];
    ab += first[i] * second[i];
    bb += second[i] * second[i];
  }
  const double a = component.cosine, b = component.sine;
  covariance.evidence = (bb * a * a - 2.0 * ab * a * b + aa * b * b) / (aa * bb - ab * ab);
  return covariance;
}

}  // namespace stillpoint

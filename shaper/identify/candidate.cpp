// SPDX-License-Identifier: Apache-2.0
#include "shaper/identify/candidate.hpp"

namespace stillpoint {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kLn2 = 0.69314718055994530942;

// Decays over the record: a window that is off by half of this step loses 5 % of the power.
constexpr double kDecays[] = {0.0, 2.0, 5.0, 12.0, 30.0, 75.0, 190.0, 480.0, 1200.0};

// exp(-decay x) times what the model leaves, and zeros. The sum of the window's squares.
double windowed_residual(const Record& record, const DecayModel& model, double decay, double* buffer, size_t size) {
  ModelSamples samples(model, record.count);
  Rotor window({-decay / static_cast<double>(record.count), 0.0});
  double sum = 0.0;
  for (size_t n = 0; n < record.count; ++n, window.advance()) {
    const double weight = window.value().re;
    buffer[n] = (static_cast<double>(record.samples[n]) - samples.next()) * weight;
    sum += weight * weight;
  }
  for (size_t n = record.count; n < size; ++n) buffer[n] = 0.0;
  return sum;
}

// Nearer to a mode there is, than that two could be told apart.
bool is_taken(const DecayModel& model, double angle) {
  for (size_t k = 0; k < model.count; ++k) {
    const double width = 0.7 * model.component[k].decay;
    const double least = 2.0 * kPi;
    if (math::magnitude(angle - model.component[k].angle) < (width > least ? width : least)) return true;
  }
  return false;
}

// Variance of what single precision rounds off at most, and more than nothing: a record that is all zeros has a floor.
double rounding_of(const Record& record) {
  double largest = 1e-30;
  for (size_t n = 0; n < record.count; ++n) {
    const double size = math::magnitude(static_cast<double>(record.samples[n]));
    largest = size > largest ? size : largest;
  }
  return math::square(0x1p-24 * largest);
}

bool is_refused(const Refused& refused, double angle) {
  for (size_t i = 0; i < refused.count; ++i) {
    if (math::magnitude(angle - refused.angle[i]) < 3.0 * kPi) return true;
  }
  return false;
}

// The value that half of power[first .. last) lies below, by bisection of the logarithm.
double median(const double* power, size_t first, size_t last) {
  double low = power[first], high = power[first];
  for (size_t k = first; k < last; ++k) {
    low = power[k] < low ? power[k] : low;
    high = power[k] > high ? power[k] : high;
  }
  if (!(high > 0.0)) return 0.0;
  if (low < 1e-30 * high) low = 1e-30 * high;
  for (int i = 0; i < 40; ++i) {
    const double middle = math::sqrt(low) * math::sqrt(high);
    size_t below = 0;
    for (size_t k = first; k < last; ++k) below += power[k] < middle ? 1 : 0;
    (2 * below < last - first ? low : high) = middle;
  }
  return high;
}

}  // namespace

bool power_of_residual(const Record& record, const DecayModel& model, double decay, double* buffer, size_t size,
                       double& weight) {
  weight = windowed_residual(record, model, decay, buffer, size);
  if (!real_fft(buffer, size)) return false;
  to_power(buffer, size);
  return true;
}

void NoiseFloor::take(const double* power, size_t size, const Record& record) {
  bands = 0;
  least = rounding_of(record);
  const auto count = static_cast<double>(record.count);
  const size_t end = size / 2;
  size_t first = 1;
  while (first < end && bands < kMostBands) {
    const size_t width = first / 2 > 12 ? first / 2 : 12;
    size_t last = first + width;
    if (last + 12 > end || bands + 1 == kMostBands) last = end;
    const double middle = median(power, first, last) / (kLn2 * count);
    centre[bands] = math::log(0.5 * static_cast<double>(first + last));
    level[bands] = math::log(middle + least);
    ++bands;
    first = last;
  }
}

double NoiseFloor::at(size_t bin) const {
  if (bands == 0) return least;
  const double x = math::log(static_cast<double>(bin > 0 ? bin : 1));
  if (x <= centre[0]) return math::exp(level[0]);
  for (size_t i = 1; i < bands; ++i) {
    if (x > centre[i]) continue;
    const double part = (x - centre[i - 1]) / (centre[i] - centre[i - 1]);
    return math::exp(level[i - 1] + part * (level[i] - level[i - 1]));
  }
  return math::exp(level[bands - 1]);
}

Candidates find_candidates(const Record& record, const DecayModel& model, const Refused& refused, double* buffer,
                           size_t size, const Meanwhile& meanwhile) {
  Candidates best{};
  NoiseFloor floor{};
  double largest = 0.0, largest_standing = 0.0;
  const double to_angle = 2.0 * kPi * static_cast<double>(record.count) / static_cast<double>(size);
  for (const double decay : kDecays) {
    double weight = 0.0;
    if (decay > 0.5 * static_cast<double>(record.count)) break;
    if (!power_of_residual(record, model, decay, buffer, size, weight)) return best;
    if (decay == 0.0) floor.take(buffer, size, record);
    for (size_t k = 1; k < size / 2; ++k) {
      const double angle = to_angle * static_cast<double>(k);
      // What loses half its logarithm in a radian rings no more; less than half a period is a drift.
      if (angle < kPi || decay > 0.5 * angle) continue;
      if (buffer[k] < buffer[k - 1] || buffer[k] < buffer[k + 1]) continue;
      const double power = buffer[k] / weight;
      if (power <= largest_standing || is_taken(model, angle) || is_refused(refused, angle)) continue;
      const ModeCandidate here{decay, to_angle * interpolated_peak(buffer, size, k), power / floor.at(k)};
      if (power > largest) {
        largest = power;
        best.largest = here;
      }
      if (here.score >= kWorthTrying) {
        largest_standing = power;
        best.standing = here;
      } else if (largest_standing == 0.0 && here.score > best.standing.score) {
        best.standing = here;
      }
    }
    meanwhile();
    if (meanwhile.is_given_up()) break;
  }
  return best;
}

void residual_spectrum(const Record& record, const DecayModel& model, double* buffer, size_t size) {
  double weight = 0.0;
  if (!power_of_residual(record, model, 0.0, buffer, size, weight)) buffer[0] = 0.0;
}

}  // namespace stillpoint

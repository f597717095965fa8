// SPDX-License-Identifier: Apache-2.0
// Mean squared errors of identify() and of Li 2017's method over the Cramer-Rao bound, for random ringing of one to
// three modes at 10 to 60 dB. Fails where the medians, the share found or the reported deviations are not what is
// promised.  Usage: identify_campaign CONFIGURATIONS SEEDS [SEED]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "shaper/identify/decrement.hpp"
#include "shaper/identify/identify.hpp"
#include "tests/shaper/identify/ringing.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Errors {
  double frequency = 0.0;  // sums of squares over the bound
  double damping = 0.0;
  int trials = 0;

  void add(double frequency_error, double damping_error, const Bound& bound) {
    frequency += frequency_error * frequency_error / bound.frequency_variance;
    damping += damping_error * damping_error / bound.damping_variance;
    ++trials;
  }
  // Infinite where it answered in fewer than half of the trials.
  double over_bound(double sum, int of) const { return 2 * trials < of ? kNever : sum / trials; }
};

double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(part * static_cast<double>(values.size() - 1))];
}

// What one row of the table holds: a number of modes and a range of signal to noise.
struct Row {
  std::vector<double> frequency, damping, li_frequency, li_damping;
  long trials = 0, found = 0, too_many = 0, estimates = 0, inside_frequency = 0, inside_damping = 0, not_viscous = 0;

  double share(long count, long of) const {
    return of == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(of);
  }
};

template <typename Mode>
const Mode* nearest(const Mode* modes, size_t count, const TrueMode& truth) {
  const Mode* best = nullptr;
  for (size_t i = 0; i < count; ++i) {
    const double distance = std::fabs(modes[i].frequency_hz - truth.frequency_hz);
    if (best == nullptr || distance < std::fabs(best->frequency_hz - truth.frequency_hz)) best = &modes[i];
  }
  return best;
}

IdentifyMemory<kLargestFft> memory;

void try_once(const Ringing& ringing, const std::vector<float>& samples, const std::vector<Bound>& bounds,
              std::vector<Errors>& own, std::vector<Errors>& lis, Row& row) {
  Identification found;
  IdentifyConfig config;
  config.rate_hz = ringing.rate_hz;
  config.least_amplitude = 0.0;
  if (!identify(record_of(samples), config, IdentifyScratch(memory), found).ok()) std::exit(2);
  const size_t modes = ringing.modes.size();
  ++row.trials;
  row.found += found.mode_count >= modes ? 1 : 0;
  row.too_many += found.mode_count > modes ? 1 : 0;
  DecrementConfig as_li;
  as_li.rate_hz = ringing.rate_hz;
  as_li.most_modes = modes;
  as_li.threshold = 0.1;
  DecrementModes decrements;
  if (!identify_by_decrement(record_of(samples), as_li, memory.buffer, kLargestFft, decrements).ok()) std::exit(2);
  for (size_t k = 0; k < modes; ++k) {
    const TrueMode& truth = ringing.modes[k];
    const IdentifiedMode* mode = nearest(found.mode, found.mode_count, truth);
    if (mode != nullptr && found.mode_count >= modes) {
      const double frequency = mode->frequency_hz - truth.frequency_hz;
      const double damping = mode->damping_ratio - truth.damping_ratio;
      own[k].add(frequency, damping, bounds[k]);
      ++row.estimates;
      row.inside_frequency += std::fabs(frequency) < mode->frequency_std_hz ? 1 : 0;
      row.inside_damping += std::fabs(damping) < mode->damping_std ? 1 : 0;
      row.not_viscous += mode->viscous ? 0 : 1;
    }
    const DecrementMode* li = nearest(decrements.mode, decrements.count, truth);
    if (li != nullptr && decrements.count >= modes) {
      lis[k].add(li->frequency_hz - truth.frequency_hz, li->damping_ratio - truth.damping_ratio, bounds[k]);
    }
  }
}

void try_configuration(Random& random, size_t modes, double ratio_db, int seeds, Row& row) {
  Ringing ringing = random_ringing(random, modes);
  const std::vector<double> samples = clean(ringing);
  ringing.noise = noise_for(samples, ratio_db);
  const std::vector<Bound> bounds = cramer_rao(ringing);
  std::vector<Errors> own(modes), lis(modes);
  for (int i = 0; i < seeds; ++i) try_once(ringing, noisy(ringing, samples, random), bounds, own, lis, row);
  for (size_t k = 0; k < modes; ++k) {
    row.frequency.push_back(own[k].over_bound(own[k].frequency, seeds));
    row.damping.push_back(own[k].over_bound(own[k].damping, seeds));
    row.li_frequency.push_back(lis[k].over_bound(lis[k].frequency, seeds));
    row.li_damping.push_back(lis[k].over_bound(lis[k].damping, seeds));
  }
}

void print(size_t modes, const char* range, const Row& row) {
  std::printf("%5zu  %-8s  %5.1f  %8.2f  %5.2f (%5.2f)  %5.2f (%5.2f)  %7.3g  %7.3g  %8.1f  %8.1f  %11.2f\n", modes,
              range, 100.0 * row.share(row.found, row.trials), 100.0 * row.share(row.too_many, row.trials),
              quantile(row.frequency, 0.5), quantile(row.frequency, 0.9), quantile(row.damping, 0.5),
              quantile(row.damping, 0.9), quantile(row.li_frequency, 0.5), quantile(row.li_damping, 0.5),
              100.0 * row.share(row.inside_frequency, row.estimates),
              100.0 * row.share(row.inside_damping, row.estimates), 100.0 * row.share(row.not_viscous, row.estimates));
}

bool is_as_promised(const Row& row, double most_over_bound) {
  const auto is_true = [&](long inside) {
    // 68 % within four standard deviations of the count, and two for what fits in one bar of each record's own.
    const double spread = 4.0 * std::sqrt(0.22 / static_cast<double>(row.estimates)) + 0.02;
    return std::fabs(row.share(inside, row.estimates) - 0.683) < spread;
  };
  return quantile(row.frequency, 0.5) <= most_over_bound && quantile(row.damping, 0.5) <= most_over_bound &&
         is_true(row.inside_frequency) && is_true(row.inside_damping) && row.share(row.found, row.trials) > 0.95;
}

}  // namespace

int main(int argc, char** argv) {
  const int configurations = argc > 1 ? std::atoi(argv[1]) : 100;
  const int seeds = argc > 2 ? std::atoi(argv[2]) : 10;
  const auto seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1ULL;
  if (configurations < 2 || seeds < 1) return 2;
  Random random(seed);
  std::printf(
      "mean squared error over the Cramer-Rao bound, median (and 9 of 10) over configurations; Li 2017's beside it;\n"
      "per cent of errors inside one reported standard deviation; all in per cent of the trials\n\n"
      "modes  dB        found  too many  f     (9/10)  zeta  (9/10)     Li f  Li zeta  f inside  z inside  not "
      "viscous\n");
  bool good = true;
  for (size_t modes = 1; modes <= 3; ++modes) {
    Row low, high;
    for (int i = 0; i < configurations; ++i) {
      const double ratio_db = i % 5 == 0 ? random.between(10.0, 20.0) : random.between(20.0, 60.0);
      try_configuration(random, modes, ratio_db, seeds, i % 5 == 0 ? low : high);
    }
    print(modes, "10 to 20", low);
    print(modes, "20 to 60", high);
    std::fflush(stdout);
    good = good && is_as_promised(high, modes == 1 ? 1.5 : 3.0);
  }
  std::printf("\nseed %llu, %d configurations of each number of modes, %d records each: %s\n", seed, configurations,
              seeds, good ? "as promised" : "FAILED");
  return good ? 0 : 1;
}

// SPDX-License-Identifier: Apache-2.0
// How often bump, stepped sine and chirp find an arm's first mode, by its damping: f within 0.5 % and zeta within 10 %
// of the arm's own, and the shaper kept. Random arms of 5 to 20 Hz, every second one with a second mode, at rest of a
// band of 4 to 40 Hz; the accelerometer, or (third argument 1) what the arm shakes its motor with. An amplitude of 1000
// counts.
// Usage: sine_campaign ARMS [SEED [FOLLOWING_ERROR]]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "sim/tuning.hpp"
#include "tests/shaper/tune/tuning_rig.hpp"
#include "tests/support/random.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr double kDampings[] = {0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3};
constexpr TuneExcitation kExcitations[] = {TuneExcitation::kBump, TuneExcitation::kSteppedSine, TuneExcitation::kChirp};

struct Score {
  int found = 0, right = 0, kept = 0;
  double of_frequency = 0.0, of_damping = 0.0;

  void take(const TuneReport& report, const Mode& mode) {
    const Identification& identification = report.identification;
    kept += report.state == TuneState::kKept ? 1 : 0;
    if (identification.finding != Finding::kFound) return;
    ++found;
    double nearest = INFINITY, damping = INFINITY;
    for (size_t k = 0; k < identification.mode_count; ++k) {
      const double off = std::fabs(identification.mode[k].frequency_hz / mode.frequency_hz - 1.0);
      if (off > nearest) continue;
      nearest = off;
      damping = std::fabs(identification.mode[k].damping_ratio / mode.damping_ratio - 1.0);
    }
    right += nearest < 0.005 && damping < 0.1 ? 1 : 0;
    of_frequency = std::max(of_frequency, nearest);
    of_damping = std::max(of_damping, damping);
  }
};

TuneReport tune(const Mode& mode, bool second, TuneExcitation excitation, bool by_error, uint64_t seed) {
  sim::ArmModes arm{{mode, 0.9}};
  if (second) arm.push_back({{std::min(2.6 * mode.frequency_hz, 34.0), 0.05}, 0.1});
  sim::SimulatedDriveConfig drive = drive_config(arm, seed);
  if (by_error) drive.reaction = 0.05;
  TuningRig rig(drive);
  TuneConfig config = tune_config(700000);
  config.excitation = excitation;
  config.source = by_error ? TuneSource::kFollowingError : TuneSource::kAccelerometer;
  config.low_hz = 4.0;
  config.high_hz = 40.0;
  config.amplitude_counts = 1000.0;
  if (!rig.tune.start(config, nullptr).ok() || !rig.run(200000)) {
    std::fprintf(stderr, "the tuning neither began nor ended\n");
    std::exit(2);
  }
  return rig.tune.report();
}

}  // namespace

int main(int argc, char** argv) {
  const int arms = argc > 1 ? static_cast<int>(std::strtol(argv[1], nullptr, 10)) : 20;
  const auto seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1ULL;
  const bool by_error = argc > 3 && argv[3][0] == '1';
  std::printf("zeta   excitation     found  right   kept  worst f %%  worst zeta %%   of %d, seed %llu, %s\n", arms,
              seed, by_error ? "following error" : "accelerometer");
  int missed = 0;
  for (const double damping : kDampings) {
    for (const TuneExcitation excitation : kExcitations) {
      Random random(seed);
      Score score;
      for (int i = 0; i < arms; ++i) {
        const Mode mode{5.0 * std::pow(4.0, random.unit()), damping};
        score.take(tune(mode, i % 2 == 1, excitation, by_error, random.next()), mode);
      }
      std::printf("%.2f   %-13s  %5d  %5d  %5d  %9.3f  %12.2f\n", damping, sim::text(excitation), score.found,
                  score.right, score.kept, 100.0 * score.of_frequency, 100.0 * score.of_damping);
      if (excitation == TuneExcitation::kSteppedSine) missed += arms - std::min(score.right, score.kept);
    }
  }
  return missed == 0 ? 0 : 1;
}

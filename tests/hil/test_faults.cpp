// SPDX-License-Identifier: Apache-2.0
// The faults of tests/firmware/fault_runs.hpp on the chip's images in the emulator, provoked from outside. What the
// emulator has not (watchdog, stack guard) or cannot be made to do (a tick that takes a millisecond) is provoked on the
// host alone; a memory without a whole set of parameters in test_stored_parameters.cpp.
//
// The test image takes those that come in whole frames, at ten times the pace; the production image those of the line
// itself. With STILLPOINT_FAULT_RUNS=N in the environment the production image takes N of all, for minutes.
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "tests/firmware/fault_runs.hpp"
#include "tests/hil/chip_drive.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

const std::string kProduction = STILLPOINT_CHIP_TREE "/stillpoint.elf";
const std::string kCampaign = STILLPOINT_CHIP_TREE "/stillpoint_campaign.elf";

uint64_t number_in_environment(const char* name, uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

// One chip for as many runs as it stands; another where the host kept it waiting.
class Chips {
 public:
  Chips(const std::string& elf, Random& random) : elf_(elf), random_(random) {}

  // What is asked of a drive, enabled; on another chip where the host was too slow.
  template <typename Run>
  void on_a_fast_enough_host(const Run& run) {
    for (int attempt = 0;; ++attempt) {
      try {
        if (drive_ == nullptr) {
          drive_ = std::make_unique<ChipDrive>(sim::start_locked(elf_), random_);
          drive_->enable();
        }
        return run(*drive_);
      } catch (const HostTooSlow&) {
        TEST_ASSERT_TRUE(attempt < kAttempts);
        drive_.reset();
        ++again_;
      }
    }
  }
  uint32_t again() const { return again_; }
  uint32_t repeated() const { return drive_ == nullptr ? 0 : drive_->repeated(); }

 private:
  static constexpr int kAttempts = 5;
  std::string elf_;
  Random& random_;
  std::unique_ptr<ChipDrive> drive_;
  uint32_t again_ = 0;
};

void provoke(const std::string& elf, const std::vector<Provocation>& all, uint64_t runs) {
  const uint64_t seed = number_in_environment("STILLPOINT_FAULT_SEED", 20261125);
  TEST_INFO("seed", seed);
  Random random(seed);
  Chips chips(elf, random);
  uint64_t moved = 0;
  for (uint64_t run = 0; run < runs; ++run) {
    TEST_INFO("run", run);
    chips.on_a_fast_enough_host([&](ChipDrive& drive) {
      FaultRun one(drive, random, all[run % all.size()]);
      one();
      if (one.moved()) ++moved;
    });
  }
  MESSAGE("seed ", seed, ", ", runs, " runs, ", moved, " of them in motion; on another chip ", chips.again(),
          ", requests repeated ", chips.repeated());
  TEST_ASSERT_AT_LEAST_INT64(runs / 3, moved);
}

bool of_the_line(const Provocation& provoked) {
  return provoked.cause == Cause::kDamaged || provoked.cause == Cause::kSilence;
}

std::vector<Provocation> provoked_where(bool (*wanted)(const Provocation&)) {
  std::vector<Provocation> all;
  for (size_t k = 0; k < kProvokedInEmulator; ++k) {
    if (wanted(kProvoked[k])) all.push_back(kProvoked[k]);
  }
  return all;
}

}  // namespace

TEST(the_chip_stands_says_why_and_recovers_whatever_is_wrong_at_any_moment_of_any_move) {
  const auto all = provoked_where([](const Provocation& provoked) { return !of_the_line(provoked); });
  provoke(kCampaign, all, 5 * all.size());
}

TEST(so_does_the_production_image_where_its_line_is_at_fault) {
  const uint64_t more = number_in_environment("STILLPOINT_FAULT_RUNS", 0);
  const auto all = provoked_where(more != 0 ? [](const Provocation&) { return true; } : of_the_line);
  provoke(kProduction, all, more != 0 ? more : 3 * all.size());
}

// SPDX-License-Identifier: Apache-2.0
// Sets of shapers through the client's door, and what happens while one is designed.
#include "firmware/shaper_settings.hpp"

#include "tests/firmware/rig.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

namespace {

constexpr uint32_t kZv = 1, kZvd = 2, kMzv = 5, kEi = 6, kCv4 = 12;

std::vector<uint16_t> block(uint32_t kind, uint32_t frequency, uint32_t damping, uint32_t tolerance, uint32_t spacing) {
  return {static_cast<uint16_t>(frequency >> 16),
          static_cast<uint16_t>(frequency),
          static_cast<uint16_t>(damping),
          static_cast<uint16_t>(tolerance),
          static_cast<uint16_t>(kind),
          static_cast<uint16_t>(spacing),
          0,
          0};
}

struct Sets : Rig {
  void stage(uint32_t set, const std::vector<uint16_t>& mode) {
    std::vector<uint16_t> words = {1, static_cast<uint16_t>(set)};
    words.insert(words.end(), mode.begin(), mode.end());
    TEST_ASSERT_EQUAL_UINT32(0, write(0x0100, words));
  }
  void stage(uint32_t set, uint32_t kind, uint32_t frequency) { stage(set, block(kind, frequency, 5000, 0, 0)); }
  void choose(uint32_t set) { TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0101, set)); }
  void apply() {
    TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 1));
    for (int i = 0; i < 50 && get(0x0131) == 2; ++i) step();
  }
  void expect_refused(Error error, Quantity quantity, uint32_t culprit, uint32_t accepted) {
    apply();
    TEST_ASSERT_EQUAL_UINT32(3, get(0x0131));
    TEST_ASSERT_EQUAL_UINT32(firmware::reason_of(error, quantity), get(0x0132));
    TEST_ASSERT_EQUAL_UINT32(get(0x0132), get(0x0012));
    TEST_ASSERT_EQUAL_UINT32(culprit, get(0x0013));
    TEST_ASSERT_EQUAL_UINT32(accepted, get_wide(0x0016));
  }
};

TEST_F(Sets, each_set_shows_what_was_staged_in_it) {
  stage(0, kZv, 110000);
  stage(3, kZvd, 370000);
  TEST_ASSERT_EQUAL_UINT32(370000, get_wide(0x0102));
  choose(0);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0100));
  TEST_ASSERT_EQUAL_UINT32(110000, get_wide(0x0102));
  TEST_ASSERT_EQUAL_UINT32(kZv, get(0x0106));
  choose(7);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0100));
  TEST_ASSERT_EQUAL_UINT32(0, get_wide(0x0102));
  choose(3);
  TEST_ASSERT_EQUAL_UINT32(kZvd, get(0x0106));
}

TEST_F(Sets, apply_runs_the_set_that_0101_names_and_choosing_one_changes_nothing_yet) {
  stage(0, kZv, 110000);
  stage(5, kZvd, 110000);
  choose(0);
  apply();
  TEST_ASSERT_EQUAL_UINT32(1, axis.shaper().stage_count);
  choose(5);
  step(10);
  TEST_ASSERT_EQUAL_UINT32(1, axis.shaper().stage_count);
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
  apply();
  TEST_ASSERT_EQUAL_UINT32(2, axis.shaper().stage_count);
  choose(1);
  apply();
  TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0131));
}

TEST_F(Sets, discard_puts_back_what_was_last_in_force_of_that_set) {
  stage(0, kZv, 110000);
  apply();
  stage(2, kZvd, 200000);
  apply();
  stage(0, kZv, 90000);
  TEST_ASSERT_EQUAL_UINT32(0, write_single(0x0130, 3));
  TEST_ASSERT_EQUAL_UINT32(110000, get_wide(0x0102));
  choose(2);
  TEST_ASSERT_EQUAL_UINT32(200000, get_wide(0x0102));
  TEST_ASSERT_EQUAL_UINT32(2, axis.shaper().stage_count);
}

TEST_F(Sets, the_predicted_residual_is_that_of_the_active_shaper_at_its_modes) {
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0136));
  stage(0, kEi, 110000);
  apply();
  TEST_ASSERT_AT_LEAST_INT64(498, get(0x0136));  // a hump of 5 % on the mode
  TEST_ASSERT_AT_MOST_INT64(502, get(0x0136));
  stage(0, block(kEi, 110000, 5000, 1000, 0));
  TEST_ASSERT_AT_MOST_INT64(502, get(0x0136));  // staged is not active
  apply();
  TEST_ASSERT_AT_LEAST_INT64(995, get(0x0136));
  TEST_ASSERT_AT_MOST_INT64(1005, get(0x0136));
  stage(0, kZv, 110000);
  apply();
  TEST_ASSERT_EQUAL_UINT32(0, get(0x0136));
}

TEST_F(Sets, what_cannot_be_designed_is_refused_by_name_and_the_old_shaper_stays) {
  stage(0, kZv, 110000);
  apply();
  TEST_ASSERT_EQUAL_UINT32(3, write(0x0102, block(kEi, 110000, 0, 9, 0)));
  TEST_ASSERT_EQUAL_UINT32(10, get_wide(0x0016));
  stage(1, block(kMzv, 110000, 0, 0, 2000));
  expect_refused(Error::kBelowMinimum, Quantity::kSpacing, 0x0107, 2500);
  stage(1, block(kCv4, 3000000, 0, 2000, 0));  // its highest zero at 1.6 times that
  apply();
  TEST_ASSERT_EQUAL_UINT32(firmware::reason_of(Error::kAboveMaximum, Quantity::kFrequency), get(0x0132));
  TEST_ASSERT_EQUAL_UINT32(0x0102, get(0x0013));
  TEST_ASSERT_EQUAL_UINT32(1, axis.shaper().stage_count);
}

// EI3 damped as much has no 5 %; what is named is taken.
TEST_F(Sets, a_tolerance_without_a_damped_shaper_is_refused_with_one_that_has) {
  stage(4, block(8, 110000, 30000, 500, 0));
  apply();
  TEST_ASSERT_EQUAL_UINT32(firmware::reason_of(Error::kAboveMaximum, Quantity::kTolerance), get(0x0132));
  TEST_ASSERT_EQUAL_UINT32(0x0105, get(0x0013));
  const uint32_t accepted = get_wide(0x0016);
  TEST_ASSERT_AT_LEAST_INT64(10, accepted);
  TEST_ASSERT_AT_MOST_INT64(499, accepted);
  stage(4, block(8, 110000, 30000, accepted, 0));
  apply();
  TEST_ASSERT_EQUAL_UINT32(1, get(0x0131));
}

// The settings alone, with a design that something comes in between of.
struct Designing {
  Axis<512> axis = {};
  firmware::Parameters parameters = {};
  firmware::ShaperSettings settings = {};
  uint32_t calls = 0;
  void (*first_call)(Designing&) = nullptr;

  Designing() {
    TEST_ASSERT_OK(axis.configure(firmware::kDefaultAxis));
    parameters.load_defaults();
    settings.begin(axis, parameters, Meanwhile{between, this});
  }
  static void between(void* self) {
    auto& designing = *static_cast<Designing*>(self);
    if (designing.calls++ == 0 && designing.first_call != nullptr) designing.first_call(designing);
  }
  void stage(uint32_t kind) {
    parameters.set(firmware::Register::kModeCount, 1);
    parameters.set(firmware::mode_register(0, firmware::ModeField::kFrequency), 200000);
    parameters.set(firmware::mode_register(0, firmware::ModeField::kKind), kind);
  }
  void apply() { settings.request_apply(Retune::kAtRest); }
  void serve() {
    for (int i = 0; i < 5; ++i) {
      settings.service();
      axis.tick();
    }
  }
};

TEST_F(Designing, a_set_prepared_before_is_not_designed_again) {
  stage(kCv4);
  apply();
  serve();
  TEST_ASSERT_EQUAL_UINT32(5, axis.shaper().stage_count);
  TEST_ASSERT_AT_LEAST_INT64(5, calls);
  settings.show_set(1);
  stage(kZv);
  apply();
  serve();
  TEST_ASSERT_EQUAL_UINT32(1, axis.shaper().stage_count);
  calls = 0;
  settings.show_set(0);
  apply();
  serve();
  TEST_ASSERT_EQUAL_UINT32(0, calls);
  TEST_ASSERT_EQUAL_UINT32(5, axis.shaper().stage_count);
  parameters.set(firmware::mode_register(0, firmware::ModeField::kDamping), 100);
  apply();
  serve();
  TEST_ASSERT_AT_LEAST_INT64(5, calls);
}

TEST_F(Designing, an_apply_that_comes_in_a_design_overtakes_it) {
  stage(kCv4);
  apply();
  first_call = [](Designing& self) {
    self.settings.show_set(1);
    self.stage(kZv);
    self.apply();
  };
  serve();
  TEST_ASSERT_EQUAL_UINT32(1, axis.shaper().stage_count);
  TEST_ASSERT_FALSE(settings.waiting());
}

TEST_F(Designing, a_discard_that_comes_in_a_design_drops_it) {
  stage(kCv4);
  apply();
  TEST_ASSERT_TRUE(settings.waiting());
  first_call = [](Designing& self) { self.settings.discard(); };
  serve();
  TEST_ASSERT_EQUAL_UINT32(0, axis.shaper().stage_count);
  TEST_ASSERT_FALSE(settings.waiting());
  TEST_ASSERT_EQUAL_UINT32(0, parameters.get(firmware::Register::kShaperState));
}

// Ticks come whenever the drive looks at its line, as interrupts would.
struct TickingLine final : hal::ByteStream {
  firmware::Application* drive = nullptr;
  std::deque<uint8_t> to_drive;

  bool read(uint8_t& byte) override {
    if (drive != nullptr) drive->tick();
    if (to_drive.empty()) return false;
    byte = to_drive.front();
    to_drive.pop_front();
    return true;
  }
  bool write(uint8_t) override { return true; }
};

TEST(the_watchdog_is_fed_and_the_client_heard_while_a_design_runs) {
  Axis<firmware::kLineCapacity> axis;
  firmware::Application drive;
  Servo servo;
  TickingLine line;
  Dog dog;
  TEST_ASSERT_OK(axis.configure(firmware::kDefaultAxis));
  drive.begin(axis, {&servo, &line, &dog});
  const auto send = [&](const Bytes& pdu) {
    Bytes body{1};
    body.insert(body.end(), pdu.begin(), pdu.end());
    const Bytes frame = framed(body);
    line.to_drive.assign(frame.begin(), frame.end());
  };
  line.drive = &drive;
  // One mode: CV4 at 20 Hz.
  send({16, 0x01, 0x00, 0, 7, 14, 0, 1, 0, 0, 0x00, 0x03, 0x0D, 0x40, 0, 0, 0, 0, 0, kCv4});
  for (int i = 0; i < 100; ++i) drive.poll();
  send({6, 0x01, 0x30, 0, 1});
  uint32_t most = 0;
  for (int i = 0; i < 100; ++i) {
    const uint32_t meals = dog.meals;
    drive.poll();
    most = dog.meals - meals > most ? dog.meals - meals : most;
  }
  TEST_ASSERT_AT_LEAST_INT64(10, most);
  TEST_ASSERT_EQUAL_UINT32(5, axis.shaper().stage_count);
}

}  // namespace

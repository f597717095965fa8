// SPDX-License-Identifier: Apache-2.0
// How a tuning ends when it is not let.
#include "tests/shaper/tune/tuning_task.hpp"

using namespace stillpoint;
using namespace stillpoint::testing;

TEST(an_abort_at_any_time_leads_back_to_the_shaper_of_before_within_limits) {
  int seen[10] = {};
  for (int at = 0; at < 6000; at += 37) {
    Tuning tuning;
    TuningRig& rig = tuning.rig;
    TEST_INFO(at, at);
    BothWays check(rig.axis->state().setpoint);
    rig.on_tick = [&](Signal setpoint) { check.next(setpoint); };
    tuning.config.accept_by_itself = at % 2 == 0;
    tuning.start();
    for (int i = 0; i < at; ++i) rig.step();
    ++seen[static_cast<int>(tuning.report().state)];
    if (!rig.tune.busy()) continue;
    rig.tune.abort();
    tuning.run_to(TuneState::kFailed);
    TEST_ASSERT_EQUAL_ENUM(Finding::kAborted, tuning.report().identification.finding);
    tuning.check_as_before();
    TEST_ASSERT_TRUE(check.within(4));
    // And nothing is left behind: it can be tuned again.
    const int32_t here = counts_from_signal(rig.axis->state().setpoint);
    tuning.config.move.target_counts = here > 300000 ? here - 500000 : here + 500000;
    TEST_ASSERT_OK(rig.tune.start(tuning.config, nullptr));
  }
  for (const TuneState state :
       {TuneState::kExciting, TuneState::kCapturing, TuneState::kProposed, TuneState::kVerifying})
    TEST_ASSERT_AT_LEAST_INT64(1, seen[static_cast<int>(state)]);
}

// Those that are over in a tick, and one whose ringing has yet to fade.
TEST(an_abort_between_two_steps_is_heard) {
  for (const bool fades_slowly : {false, true}) {
    for (const TuneState state : {TuneState::kIdentifying, TuneState::kApplying}) {
      for (int later = 0; later < 3; ++later) {
        Tuning tuning;
        if (fades_slowly) tuning.rig.drive = sim::SimulatedDrive(drive_config({{{3.0, 0.01}, 0.9}}, 7));
        tuning.start();
        tuning.run_until(state);
        for (int i = 0; i < later; ++i) tuning.rig.step();
        tuning.rig.tune.abort();
        tuning.run_to(TuneState::kFailed);
        TEST_ASSERT_EQUAL_ENUM(Finding::kAborted, tuning.report().identification.finding);
        tuning.check_as_before();
      }
    }
  }
}

TEST(a_ringing_that_fades_slowly_is_waited_for) {
  TuningRig rig(sim::ArmModes{{{2.5, 0.008}, 0.9}});
  TEST_ASSERT_OK(rig.tune.start(tune_config(kDistance), nullptr));
  uint32_t waited = 0;
  for (int i = 0; i < 100000 && rig.tune.busy(); ++i) {
    rig.step();
    waited += rig.tune.report().state == TuneState::kApplying ? 1U : 0U;
  }
  TEST_ASSERT_EQUAL_ENUM(TuneState::kKept, rig.tune.report().state);
  // To a tenth, less what was recorded.
  TEST_ASSERT_DOUBLE_WITHIN(0.3, 2.303 / (2.0 * M_PI * 2.5 * 0.008) - 2.05, waited * kTuneTick);
}

TEST_F(Tuning, an_abort_while_it_thinks_is_heard) {
  struct Call {
    AutoTune* tune;
    int count;
  } call{&rig.tune, 0};
  const Meanwhile meanwhile{[](void* context) {
                              Call& to = *static_cast<Call*>(context);
                              if (++to.count == 5) to.tune->abort();
                            },
                            &call};
  start();
  for (int i = 0; i < 100000 && rig.tune.busy(); ++i) {
    rig.tick();
    rig.tune.service(meanwhile);
  }
  TEST_ASSERT_AT_LEAST_INT64(5, call.count);
  TEST_ASSERT_EQUAL_ENUM(TuneState::kFailed, report().state);
  TEST_ASSERT_EQUAL_ENUM(Finding::kAborted, report().identification.finding);
  check_as_before();
}

TEST(a_stop_or_a_reset_from_elsewhere_aborts) {
  for (int what = 0; what < 2; ++what) {
    for (int at = 5; at < 4000; at += 331) {
      TEST_INFO(what, what);
      TEST_INFO(at, at);
      Tuning tuning;
      tuning.start();
      for (int i = 0; i < at; ++i) tuning.rig.step();
      const AxisPhase phase = tuning.rig.axis->state().phase;
      const bool moves = phase == AxisPhase::kMoving || phase == AxisPhase::kDraining;
      const TuneState state = tuning.report().state;
      if (!tuning.rig.tune.busy() || (what == 0 && !moves)) continue;
      if (what == 0) tuning.rig.axis->request_stop();
      if (what == 1) tuning.rig.axis->reset(signal_from_counts(123456));
      TEST_ASSERT_TRUE(tuning.rig.run());
      // A reset while nothing moves and nothing is listened to does no harm.
      if (what == 1 && state == TuneState::kApplying) continue;
      TEST_ASSERT_EQUAL_ENUM(TuneState::kFailed, tuning.report().state);
      TEST_ASSERT_EQUAL_ENUM(Finding::kAborted, tuning.report().identification.finding);
      tuning.check_as_before();
    }
  }
}

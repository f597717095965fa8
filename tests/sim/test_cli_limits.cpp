// SPDX-License-Identifier: Apache-2.0
// `stillpoint limits` with the figures of the lecture on profiles.
#include "tests/sim/cli_checks.hpp"

using stillpoint::testing::check_keys;
using stillpoint::testing::check_refused;
using stillpoint::testing::Json;
using stillpoint::testing::json_of;

TEST_HOST(limits_of_the_lectures_stage) {
  const Json limits = json_of(
      "limits --motor-rpm 12000 --gear-ratio 2 --pitch 0.01 --pulses-per-rev 4000 --counter-max-hz 3200000 "
      "--torque-constant 0.1 --max-current 2.5 --gear-efficiency 0.5 --screw-efficiency 0.7 --friction-force 10 "
      "--mass 10");
  check_keys(limits, {"velocity", "velocity_limited_by", "acceleration", "acceleration_limited_by"});
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, limits["velocity"].get<double>());
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, limits["velocity_candidates"]["counter"].get<double>());
  TEST_ASSERT_DOUBLE_WITHIN(5e-3, 10.0, limits["acceleration"].get<double>());
  REQUIRE(limits["acceleration_limited_by"] == "force");
  REQUIRE(limits["jerk"].is_null());
}

TEST_HOST(limits_refuse_by_the_options_name) {
  check_refused(2, "--mass: -1: ", "limits --mass -1");
  check_refused(2, "efficiency: 1.5: above the maximum, at most 1 is accepted", "limits --gear-efficiency 1.5");
  check_refused(2, "friction force: 60: above the maximum, at most 50 is accepted",
                "limits --force-constant 10 --max-current 5 --mass 1 --friction-force 60");
}

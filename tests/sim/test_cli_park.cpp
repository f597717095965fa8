// SPDX-License-Identifier: Apache-2.0
// `stillpoint park` as a program.
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/sim/cli_checks.hpp"

using stillpoint::testing::check_refused;
using stillpoint::testing::Json;
using stillpoint::testing::Outcome;
using stillpoint::testing::read_text;
using stillpoint::testing::run_program;
using stillpoint::testing::scratch_file;

TEST_HOST(park_prints_every_experiment_as_json) {
  const Outcome outcome = run_program("park --json");
  TEST_ASSERT_EQUAL_INT32(0, outcome.exit_code);
  TEST_ASSERT_TRUE(outcome.errors.empty());
  const Json park = Json::parse(outcome.output);
  REQUIRE(park.at("result") == "ok");
  REQUIRE(park.at("tick_s") == 0.001);
  int rows_of_16 = 0;
  for (const Json& row : park.at("rows")) {
    for (const char* key : {"figure", "quantity", "unit", "paper", "continuous", "on_plant"}) {
      TEST_INFO(key, key);
      TEST_ASSERT_TRUE(row.contains(key));
    }
    rows_of_16 += row["figure"] == 16 && row["paper"].is_number() ? 1 : 0;
  }
  TEST_ASSERT_EQUAL_INT32(2, rows_of_16);
  TEST_ASSERT_EQUAL_UINT32(3, park.at("plants").size());
  for (const Json& plant : park["plants"]) {
    for (const char* key : {"figure", "mass_kg", "stiffness_n_per_m", "damping_n_s_per_m", "frequency_hz"})
      TEST_ASSERT_TRUE(plant.contains(key));
  }
}

TEST_HOST(park_prints_a_table_and_writes_the_traces) {
  const std::string csv_file = scratch_file("park.csv");
  const Outcome outcome = run_program("park --csv " + csv_file);
  TEST_ASSERT_EQUAL_INT32(0, outcome.exit_code);
  for (const char* text : {"Fig. 10: 4-hump CV", "Fig. 13: 3 humps", "Fig. 17: 3-hump EI", "paper"}) {
    TEST_INFO(text, text);
    TEST_ASSERT_TRUE(outcome.output.find(text) != std::string::npos);
  }
  const std::string csv = read_text(csv_file);
  TEST_ASSERT_TRUE(csv.find("\ntime_s,ei_15,cv_15,ei_16,cv_16,ei_17,cv_17\n0,0,0,") != std::string::npos);
}

TEST_HOST(park_refuses_what_it_does_not_know) {
  check_refused(2, "option: --shaper: not known to `park`, accepted: ", "park --shaper zv:4:0");
  check_refused(2, "argument: now: not known to `park`, accepted: ", "park now");
  check_refused(2, "--plot: park.pdf: ", "park --plot park.pdf");
  check_refused(2, "--csv: /nowhere/x.csv: ", "park --csv /nowhere/x.csv");
}

TEST_HOST(park_draws_the_time_responses_where_gnuplot_is) {
  if (std::system("gnuplot --version >/dev/null 2>&1") != 0) return;
  const std::string file = scratch_file("park.svg");
  TEST_ASSERT_EQUAL_INT32(0, run_program("park --plot " + file).exit_code);
  TEST_ASSERT_TRUE(std::filesystem::file_size(file) > 10000);
}

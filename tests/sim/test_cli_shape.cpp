// SPDX-License-Identifier: Apache-2.0
// `stillpoint shape` as a filter.
#include <string>
#include <vector>

#include "tests/sim/program.hpp"
#include "tests/support/test.hpp"

using stillpoint::testing::Outcome;
using stillpoint::testing::Random;
using stillpoint::testing::run_program;

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  size_t start = 0;
  for (size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', start)) {
    lines.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return lines;
}

std::vector<std::string> shaped(const std::string& arguments, const std::string& input) {
  const Outcome outcome = run_program("shape " + arguments, input);
  TEST_INFO(errors, outcome.errors);
  TEST_ASSERT_EQUAL_INT32(0, outcome.exit_code);
  return lines_of(outcome.output);
}

void check_refused(const std::string& error, const std::string& arguments, const std::string& input) {
  const Outcome outcome = run_program("shape " + arguments, input);
  TEST_INFO(errors, outcome.errors);
  TEST_ASSERT_EQUAL_INT32(2, outcome.exit_code);
  TEST_ASSERT_TRUE(outcome.errors.rfind("stillpoint: error: " + error, 0) == 0);
}

}  // namespace

TEST_HOST(a_step_goes_out_as_the_impulses_and_ends_exactly) {
  const std::vector<std::string> lines = shaped("--shaper zv:11:0.11", "1000\n");
  TEST_ASSERT_EQUAL_UINT32(47, lines.size());  // 46 ticks of line after the step
  REQUIRE(lines[0] == "585.942290723323822021484375");
  REQUIRE(lines[44] == lines[0]);
  REQUIRE(lines[45] == "697.530514560639858245849609375");
  REQUIRE(lines[46] == "1000");
}

TEST_HOST(without_a_shaper_counts_go_through) {
  REQUIRE(shaped("--shaper none", "5\n-7\n+3\r\n") == std::vector<std::string>{"5", "-7", "3"});
  REQUIRE(shaped("--shaper none", "").empty());
}

TEST_HOST(any_stream_of_counts_ends_exactly_on_its_last_value) {
  const char* shapers[] = {"zv:11:0.11", "zvd:37.3:0.02", "zv:0.9:0+zvd:150:0.3", "zv:480:0.1+zv:3.3:0.2+zvd:77:0"};
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    TEST_INFO(seed, seed);
    Random random(seed);
    std::string input;
    int64_t last = 0;
    for (int64_t i = random.integer(1, 400); i > 0; --i) {
      // Steps of up to 2^31 - 1 within the range; now and then its ends.
      const int64_t low = std::max<int64_t>(INT32_MIN, last - INT32_MAX);
      const int64_t high = std::min<int64_t>(INT32_MAX, last + INT32_MAX);
      const int64_t kind = random.integer(0, 9);
      last = kind == 0 ? low : kind == 1 ? high : random.integer(low, high);
      input += std::to_string(last) + "\n";
    }
    const std::vector<std::string> lines = shaped(std::string("--shaper ") + shapers[seed % 4], input);
    REQUIRE(lines.back() == std::to_string(last));
  }
}

TEST_HOST(a_retune_at_rest_takes_effect_at_its_tick) {
  // GIVEN an input that has stood for longer than the first shaper WHEN it is exchanged at rest and the input steps at
  // that very tick THEN the new shaper is in force and nothing jumps.
  std::string input = "100\n";
  for (int i = 1; i < 60; ++i) input += "100\n";
  input += "200\n";
  const std::vector<std::string> lines = shaped("--shaper zv:11:0.11 --retune 60=none", input);
  REQUIRE(lines[59] == "100");
  REQUIRE(lines[60] == "200");
  TEST_ASSERT_EQUAL_UINT32(61, lines.size());
}

TEST_HOST(a_retune_while_moving_waits_for_rest) {
  // The step at tick 10 is under way when the retune comes due at 12; it rests at 10 + 46, steps again at 80.
  std::string input;
  for (int i = 0; i < 10; ++i) input += "0\n";
  for (int i = 10; i < 80; ++i) input += "1000\n";
  input += "0\n";
  const std::vector<std::string> lines = shaped("--shaper zv:11:0.11 --retune 12=none", input);
  REQUIRE(lines[11] == "585.942290723323822021484375");
  REQUIRE(lines[55] == "697.530514560639858245849609375");
  REQUIRE(lines[56] == "1000");
  REQUIRE(lines[80] == "0");
}

TEST_HOST(with_limits_a_retune_is_blended_into_a_cruise) {
  // GIVEN a smooth start, a cruise of 1000 counts a tick and a smooth end WHEN a longer shaper is asked for in between
  std::string input;
  int64_t position = 0, velocity = 0;
  for (int i = 0; i < 1500; ++i) {
    velocity += i < 200 ? 5 : i >= 1300 ? -5 : 0;
    position += velocity;
    input += std::to_string(position) + "\n";
  }
  const std::string limits = " --velocity 1.2 --acceleration 20 --jerk 600";
  const std::vector<std::string> before = shaped("--shaper zv:37:0", input);
  const std::vector<std::string> after = shaped("--shaper zvd:15:0", input);
  const std::vector<std::string> lines = shaped("--shaper zv:37:0 --retune 400=zvd:15:0" + limits, input);
  // THEN it is in force within the cruise, nothing jumps, and the end is exact
  TEST_ASSERT_EQUAL_UINT32(after.size(), lines.size());
  for (size_t i = 0; i <= 460; ++i) REQUIRE(lines[i] == before[i]);
  for (size_t i = 700; i < lines.size(); ++i) REQUIRE(lines[i] == after[i]);
  double last = 0.0, step = 0.0;
  for (const std::string& line : lines) {
    const double next = std::stod(line);
    TEST_ASSERT_AT_MOST_DOUBLE(1200.0, next - last);
    TEST_ASSERT_DOUBLE_WITHIN(20.0, 0.0, next - last - step);
    step = next - last;
    last = next;
  }
  // AND a velocity limit that the cruise uses up leaves no room to catch up with a shorter one before it brakes
  const std::vector<std::string> tight =
      shaped("--shaper zvd:15:0 --retune 400=zv:37:0 --velocity 1 --acceleration 20 --jerk 600", input);
  for (size_t i = 0; i < 1300; ++i) REQUIRE(tight[i] == after[i]);
  REQUIRE(tight.back() == after.back());
}

TEST_HOST(limits_are_taken_whole_and_change_nothing_without_a_retune) {
  check_refused("--jerk: missing", "--shaper none --velocity 1 --acceleration 1", "1\n");
  check_refused("--velocity: -1: ", "--shaper none --velocity=-1 --acceleration 1 --jerk 1", "1\n");
  check_refused("--retune: 9=none: the stream ended at tick 1 before it",
                "--shaper none --retune 9=none --velocity 1 --acceleration 1 --jerk 1", "1\n");
  const std::string limits = " --velocity 1 --acceleration 1 --jerk 1";
  REQUIRE(shaped("--shaper zv:11:0.11" + limits, "7\n5\n100\n") == shaped("--shaper zv:11:0.11", "7\n5\n100\n"));
}

TEST_HOST(what_is_not_a_count_is_refused_by_its_line) {
  check_refused("standard input, line 1: abc: not an integer", "--shaper none", "abc\n");
  check_refused("standard input, line 3: 1.5: not an integer", "--shaper none", "1\n2\n1.5\n");
  check_refused("standard input, line 2: : not an integer", "--shaper none", "1\n\n");
  check_refused("standard input, line 2: 2147483648: out of range", "--shaper zv:11:0.1", "1\n2147483648\n");
  check_refused("standard input, line 1: -2147483649: out of range", "--shaper zv:11:0.1", "-2147483649\n");
  check_refused("--retune: 5: not TICK=SPEC", "--shaper none --retune 5", "1\n");
  check_refused("--retune: -1: out of range", "--shaper none --retune=-1=none", "1\n");
  check_refused("shaper type: xy: ", "--shaper none --retune 5=xy:3:0", "1\n");
}

// SPDX-License-Identifier: Apache-2.0
// Numbers and specifications as people write them.
#include <algorithm>
#include <string>

#include "sim/refusal.hpp"
#include "sim/spec.hpp"
#include "sim/text.hpp"
#include "tests/support/test.hpp"

using namespace stillpoint;  // a test of many small names
using namespace stillpoint::sim;

namespace {

// The refusal's line and exit code, or "accepted".
template <typename Action>
std::string refusal_of(const Action& action) {
  try {
    action();
  } catch (const Refusal& refusal) {
    return std::to_string(refusal.exit_code()) + " " + refusal.what();
  }
  return "accepted";
}

bool begins_with(const std::string& text, const std::string& beginning) {
  return text.compare(0, beginning.size(), beginning) == 0;
}

#define TEST_ASSERT_REFUSAL(beginning, action)                \
  do {                                                        \
    const std::string refusal_ = refusal_of([&] { action; }); \
    TEST_INFO(refusal, refusal_);                             \
    TEST_ASSERT_TRUE(begins_with(refusal_, beginning));       \
  } while (false)

// Reads an exact decimal back by doubling its digits: 32 times, after which none may be left.
int64_t signal_from_decimal(const std::string& text) {
  const bool negative = text[0] == '-';
  const size_t point = std::min(text.find('.'), text.size());
  uint64_t magnitude = std::stoull(text.substr(negative ? 1 : 0, point - (negative ? 1 : 0)));
  std::string digits = point < text.size() ? text.substr(point + 1) : "";
  for (int bit = 0; bit < 32; ++bit) {
    int carry = 0;
    for (size_t i = digits.size(); i-- > 0;) {
      const int twice = 2 * (digits[i] - '0') + carry;
      digits[i] = static_cast<char>('0' + twice % 10);
      carry = twice / 10;
    }
    magnitude = 2 * magnitude + static_cast<uint64_t>(carry);
  }
  TEST_ASSERT_TRUE(digits.find_first_not_of('0') == std::string::npos);
  return static_cast<int64_t>(negative ? UINT64_C(0) - magnitude : magnitude);
}

}  // namespace

TEST_HOST(whole_counts_print_as_integers) {
  REQUIRE(exact_counts(0) == "0");
  REQUIRE(exact_counts(signal_from_counts(1700000)) == "1700000");
  REQUIRE(exact_counts(signal_from_counts(-42)) == "-42");
  REQUIRE(exact_counts(signal_from_counts(INT32_MAX)) == "2147483647");
  REQUIRE(exact_counts(signal_from_counts(INT32_MIN)) == "-2147483648");
}

TEST_HOST(fractions_print_to_their_last_digit) {
  REQUIRE(exact_counts(kSignalPerCount / 2) == "0.5");
  REQUIRE(exact_counts(-kSignalPerCount / 4) == "-0.25");
  REQUIRE(exact_counts(1) == "0.00000000023283064365386962890625");
  REQUIRE(exact_counts(-1) == "-0.00000000023283064365386962890625");
  REQUIRE(exact_decimal(3, 30) == "0.000000002793967723846435546875");
  REQUIRE(exact_decimal(5, 0) == "5");
}

TEST_HOST(exact_decimals_read_back_as_the_same_bits) {
  testing::Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const int64_t value = static_cast<int64_t>(random.next()) >> random.integer(0, 60);
    TEST_INFO(value, value);
    TEST_ASSERT_EQUAL_INT64(value, signal_from_decimal(exact_counts(value)));
  }
}

TEST_HOST(numbers_are_taken_whole_or_refused_by_name) {
  TEST_ASSERT_TRUE(parse_number("-1.5e3", "x") == -1500.0);
  TEST_ASSERT_TRUE(parse_number("+2", "x") == 2.0);
  for (const char* text : {"", "abc", "1.5x", "1,5", " 1", "0x10", "+-1", "--1", "1e"}) {
    TEST_INFO(text, text);
    TEST_ASSERT_REFUSAL("2 x: ", static_cast<void>(parse_number(text, "x")));
  }
  TEST_ASSERT_REFUSAL("2 x: nan: not a finite number", static_cast<void>(parse_number("nan", "x")));
  TEST_ASSERT_REFUSAL("2 x: -inf: not a finite number", static_cast<void>(parse_number("-inf", "x")));
  TEST_ASSERT_REFUSAL("2 x: 1e999: not a finite number", static_cast<void>(parse_number("1e999", "x")));
  TEST_ASSERT_REFUSAL("2 x: 0: must be above zero", static_cast<void>(parse_positive("0", "x")));
}

TEST_HOST(integers_are_taken_whole_and_in_range) {
  TEST_ASSERT_EQUAL_INT64(INT32_MIN, parse_integer("-2147483648", "x", INT32_MIN, INT32_MAX));
  TEST_ASSERT_EQUAL_INT64(INT32_MAX, parse_integer("+2147483647", "x", INT32_MIN, INT32_MAX));
  for (const char* text : {"", "1.0", "1e3", "2147483648", "-2147483649", "99999999999999999999", "x"}) {
    TEST_INFO(text, text);
    TEST_ASSERT_REFUSAL("2 x: ", static_cast<void>(parse_integer(text, "x", INT32_MIN, INT32_MAX)));
  }
}

TEST_HOST(a_specification_is_taken_apart) {
  const std::vector<SpecifiedShaper> specs = parse_shapers("zv:11:0.11+zvd:37.3:0.05:v=0.02+none");
  TEST_ASSERT_EQUAL_UINT32(2, specs.size());
  TEST_ASSERT_EQUAL_ENUM(ShaperKind::kZv, specs[0].kind);
  TEST_ASSERT_TRUE(specs[0].mode.frequency_hz == 11.0 && specs[0].mode.damping_ratio == 0.11);
  TEST_ASSERT_TRUE(specs[0].tolerance == 0.05);
  TEST_ASSERT_EQUAL_ENUM(ShaperKind::kZvd, specs[1].kind);
  TEST_ASSERT_TRUE(specs[1].tolerance == 0.02);
  REQUIRE(spec_text(specs[1]) == "zvd:37.3:0.05:v=0.02");
  TEST_ASSERT_EQUAL_UINT32(0, parse_shapers("none").size());
  TEST_ASSERT_EQUAL_UINT32(0, parse_shapers("none:11:0.1").size());
}

TEST_HOST(a_specification_that_is_none_is_refused_by_what_is_wrong_with_it) {
  const auto refused = [](const char* text) { return refusal_of([&] { static_cast<void>(parse_shapers(text)); }); };
  REQUIRE(refused("xy:11:0.1") ==
          "2 shaper type: xy: not a known type, accepted: zv zvd zvdd zvddd mzv ei ei2 ei3 cv1 cv2 cv3 cv4 um-zv "
          "custom none");
  REQUIRE(begins_with(refused(""), "2 shaper type: : "));
  REQUIRE(begins_with(refused("zv:11"), "2 shaper: zv:11: not a shaper specification"));
  REQUIRE(begins_with(refused("zv:11:0.1:v=0.1:x"), "2 tolerance: 0.1:x: "));
  REQUIRE(begins_with(refused("zv:x:0.1"), "2 frequency: x: not a number"));
  REQUIRE(begins_with(refused("zv:-11:0.1"), "2 frequency: -11: must be above zero"));
  REQUIRE(begins_with(refused("zv:11:1"), "2 damping ratio: 1: out of range"));
  REQUIRE(begins_with(refused("zv:11:-0.1"), "2 damping ratio: -0.1: out of range"));
  REQUIRE(begins_with(refused("zv:11:0.1:w=3"), "2 shaper key: w=3: not known"));
  REQUIRE(begins_with(refused("zv:11:0.1:v=1.5"), "2 tolerance: 1.5: out of range"));
  REQUIRE(begins_with(refused("zv:11:0.1+"), "2 shaper type: : "));
}

TEST_HOST(a_design_that_cannot_be_says_what_could) {
  const auto refused = [](const char* text) {
    return refusal_of([&] { static_cast<void>(design_for(parse_shapers(text), 1e-3)); });
  };
  REQUIRE(refused("zv:600:0.1") == "2 frequency: 600: above the maximum, at most 490 is accepted");
  REQUIRE(refused("zv:11:0.5") == "2 damping ratio: 0.5: above the maximum, at most 0.3 is accepted");
}

TEST_HOST(an_arm_is_taken_apart_and_shares_left_out_are_filled_in) {
  const ArmModes one = parse_arm("11:0.11");
  TEST_ASSERT_TRUE(one.size() == 1 && one[0].share == 1.0 && one[0].mode.frequency_hz == 11.0);
  const ArmModes two = parse_arm("11:0.11:0.7,40:0.02");
  TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.3, two[1].share);
  const ArmModes rigid = parse_arm("11:0:0.4");
  TEST_ASSERT_TRUE(rigid[0].share == 0.4);
  TEST_ASSERT_REFUSAL("2 arm: 11: not a mode", static_cast<void>(parse_arm("11")));
  TEST_ASSERT_REFUSAL("2 arm: 11:0.1:0.8,30:0.1:0.3: the shares",
                      static_cast<void>(parse_arm("11:0.1:0.8,30:0.1:0.3")));
  TEST_ASSERT_REFUSAL("2 arm: 11:0.1:1,30:0.1: nothing is left", static_cast<void>(parse_arm("11:0.1:1,30:0.1")));
  TEST_ASSERT_REFUSAL("2 damping ratio: 1.5", static_cast<void>(parse_arm("11:1.5")));
}

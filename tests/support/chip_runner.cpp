// SPDX-License-Identifier: Apache-2.0
#include "tests/support/chip_runner.hpp"

#include "tests/support/semihosting.hpp"

// The linker's names for the ends of the section.
extern "C" const stillpoint::testing::Case __start_stillpoint_cases[] __attribute__((weak));
extern "C" const stillpoint::testing::Case __stop_stillpoint_cases[] __attribute__((weak));

namespace stillpoint::testing {
namespace {

enum ExitCode : uint32_t { kPassed = 0, kFailed = 1, kNoCases = 2, kFault = 3 };

const char* running = "(none)";

void print_unsigned(uint64_t value) {
  char digits[21] = {};
  size_t at = sizeof(digits) - 1;
  do {
    digits[--at] = static_cast<char>('0' + value % 10);
    value /= 10;
  } while (value != 0);
  print(&digits[at]);
}

void print_integer(int64_t value) {
  if (value < 0) print("-");
  print_unsigned(value < 0 ? ~static_cast<uint64_t>(value) + 1 : static_cast<uint64_t>(value));
}

// Nine significant digits, and the bits, which are exact.
void print_real(double value) {
  uint64_t bits = 0;
  __builtin_memcpy(&bits, &value, sizeof(bits));
  if (value != value || value - value != 0.0) {
    print(value != value ? "nan" : value > 0 ? "inf" : "-inf");
  } else {
    if ((bits >> 63) != 0) print("-");
    double magnitude = value < 0 ? -value : value;
    int exponent = 0;
    if (magnitude > 0.0) {
      for (; magnitude >= 10.0; ++exponent) magnitude /= 10.0;
      for (; magnitude < 1.0; --exponent) magnitude *= 10.0;
    }
    const uint64_t digits = static_cast<uint64_t>(magnitude * 1e8 + 0.5);
    print_unsigned(digits / 100000000);
    print(".");
    for (uint64_t place = 10000000; place > 0; place /= 10) print_unsigned(digits / place % 10);
    print("e");
    print_integer(exponent);
  }
  print(" (0x");
  for (int shift = 60; shift >= 0; shift -= 4) {
    const char digit[2] = {"0123456789abcdef"[(bits >> shift) & 0xF], '\0'};
    print(digit);
  }
  print(")");
}

void print_failure(const char* file, int line, const char* assertion) {
  print(file);
  print(":");
  print_integer(line);
  print(": ");
  print(running);
  print(": ");
  print(assertion);
  print("\n");
}

[[noreturn]] void end_failed() {
  Info::print_all();
  semihosting::exit(kFailed);
}

}  // namespace

const Info* Info::innermost = nullptr;

void Info::print_all() {
  for (const Info* info = innermost; info != nullptr; info = info->outer_) {
    print("  ");
    print(info->name_);
    print(" = ");
    print(info->value_);
    print("\n");
  }
}

void print(const char* text) { semihosting::write0(text); }

void print(const Value& value) {
  switch (value.kind) {
    case Value::Kind::kInteger: return print_integer(value.integer);
    case Value::Kind::kUnsigned: return print_unsigned(static_cast<uint64_t>(value.integer));
    case Value::Kind::kReal: return print_real(value.real);
    case Value::Kind::kText: return print(value.text);
  }
}

void fail(const char* file, int line, const char* assertion) {
  print_failure(file, line, assertion);
  end_failed();
}

void fail(const char* file, int line, const char* assertion, const Value& expected, const Value& actual) {
  print_failure(file, line, assertion);
  print("  left ");
  print(expected);
  print(", right ");
  print(actual);
  print("\n");
  end_failed();
}

static int run_all() {
  uint32_t count = 0;
  for (const Case* one = __start_stillpoint_cases; one < __stop_stillpoint_cases; ++one) {
    running = one->name;
    one->run();
    ++count;
  }
  print_unsigned(count);
  print(" cases passed\n");
  return count == 0 ? kNoCases : kPassed;
}

}  // namespace stillpoint::testing

// A fault in a test image ends it, instead of waiting for a watchdog (see startup.cpp).
extern "C" void safe_state();
extern "C" void safe_state() {
  stillpoint::testing::print("fault handler reached in ");
  stillpoint::testing::print(stillpoint::testing::running);
  stillpoint::testing::print("\n");
  stillpoint::semihosting::exit(stillpoint::testing::kFault);
}

int main() { stillpoint::semihosting::exit(static_cast<uint32_t>(stillpoint::testing::run_all())); }

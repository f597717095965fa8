// SPDX-License-Identifier: Apache-2.0
// The chip's side of test.hpp. A case is a constant in a section of its own that the linker strings together, so no
// constructor runs before main. The first failure ends the image: there is no stack to unwind, and what a half-done
// case leaves behind would only mislead.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace stillpoint::testing {

struct Case {
  const char* name;
  void (*run)();
};

struct Value {
  enum class Kind : uint8_t { kInteger, kUnsigned, kReal, kText } kind;
  int64_t integer;
  double real;
  const char* text;
};

inline Value value_of(bool value) { return {Value::Kind::kInteger, value ? 1 : 0, 0.0, nullptr}; }
inline Value value_of(int value) { return {Value::Kind::kInteger, value, 0.0, nullptr}; }
inline Value value_of(long value) { return {Value::Kind::kInteger, value, 0.0, nullptr}; }
inline Value value_of(long long value) { return {Value::Kind::kInteger, value, 0.0, nullptr}; }
inline Value value_of(unsigned value) { return {Value::Kind::kUnsigned, static_cast<int64_t>(value), 0.0, nullptr}; }
inline Value value_of(unsigned long value) {
  return {Value::Kind::kUnsigned, static_cast<int64_t>(value), 0.0, nullptr};
}
inline Value value_of(unsigned long long value) {
  return {Value::Kind::kUnsigned, static_cast<int64_t>(value), 0.0, nullptr};
}
inline Value value_of(double value) { return {Value::Kind::kReal, 0, value, nullptr}; }
inline Value value_of(const char* value) { return {Value::Kind::kText, 0, 0.0, value}; }

// What TEST_INFO said, innermost first; printed with a failure.
class Info {
 public:
  template <typename T>
  Info(const char* name, const T& value) : name_(name), value_(value_of(value)), outer_(innermost) {
    innermost = this;
  }
  ~Info() { innermost = outer_; }
  Info(const Info&) = delete;
  Info& operator=(const Info&) = delete;

  static void print_all();

 private:
  static const Info* innermost;

  const char* name_;
  Value value_;
  const Info* outer_;
};

[[noreturn]] void fail(const char* file, int line, const char* assertion);
[[noreturn]] void fail(const char* file, int line, const char* assertion, const Value& expected, const Value& actual);

// For programs that print: to the emulator's console.
void print(const char* text);
void print(const Value& value);

}  // namespace stillpoint::testing

#define STILLPOINT_JOIN_(a, b) a##b
#define STILLPOINT_JOIN(a, b) STILLPOINT_JOIN_(a, b)

#define STILLPOINT_CASE_(name, function)                                                                           \
  __attribute__((section("stillpoint_cases"), used)) static const stillpoint::testing::Case name##_case_ = {#name, \
                                                                                                            function};

#define TEST(name)             \
  static void name();          \
  STILLPOINT_CASE_(name, name) \
  static void name()

// Names of its own, since the fixture's members are in scope.
#define TEST_F(fixture, name)             \
  namespace {                             \
  struct name : fixture {                 \
    void case_body_();                    \
    static void run_case_() {             \
      name fixture_of_case;               \
      fixture_of_case.case_body_();       \
    }                                     \
  };                                      \
  }                                       \
  STILLPOINT_CASE_(name, name::run_case_) \
  void name::case_body_()

// Compiled, so that it does not rot, and thrown away by the linker.
#define TEST_HOST(name) [[maybe_unused]] static void name()
#define TEST_HOST_F(fixture, name) \
  namespace {                      \
  struct name : fixture {          \
    void case_body_();             \
  };                               \
  }                                \
  [[maybe_unused]] void name::case_body_()

#define TEST_INFO(name, value) const stillpoint::testing::Info STILLPOINT_JOIN(info_, __LINE__)(#name, value)

#define TEST_ASSERT_TRUE(condition) \
  ((condition) ? static_cast<void>(0) : stillpoint::testing::fail(__FILE__, __LINE__, #condition " is not true"))
#define TEST_ASSERT_FALSE(condition) \
  ((condition) ? stillpoint::testing::fail(__FILE__, __LINE__, #condition " is not false") : static_cast<void>(0))
#define TEST_ASSERT_COMPARE_(type, expected, op, actual)                           \
  do {                                                                             \
    const type expected_value_ = static_cast<type>(expected);                      \
    const type actual_value_ = static_cast<type>(actual);                          \
    if (!(expected_value_ op actual_value_)) {                                     \
      stillpoint::testing::fail(__FILE__, __LINE__, #expected " " #op " " #actual, \
                                stillpoint::testing::value_of(expected_value_),    \
                                stillpoint::testing::value_of(actual_value_));     \
    }                                                                              \
  } while (false)

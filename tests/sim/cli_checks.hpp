// SPDX-License-Identifier: Apache-2.0
// What every command of the program is held to.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/sim/program.hpp"
#include "tests/support/test.hpp"

namespace stillpoint::testing {

using Json = nlohmann::json;

inline void check_refused(int exit_code, const std::string& error, const std::string& arguments) {
  TEST_INFO(arguments, arguments);
  const Outcome outcome = run_program(arguments);
  TEST_INFO(errors, outcome.errors);
  TEST_ASSERT_EQUAL_INT32(exit_code, outcome.exit_code);
  TEST_ASSERT_TRUE(outcome.errors.rfind("stillpoint: error: " + error, 0) == 0);
  TEST_ASSERT_TRUE(outcome.errors.find('\n') == outcome.errors.size() - 1);
  if (exit_code == 2) TEST_ASSERT_TRUE(outcome.output.empty());
}

// Exactly one object, nothing around it.
inline Json json_of(const std::string& arguments) {
  TEST_INFO(arguments, arguments);
  const Outcome outcome = run_program(arguments + " --json");
  TEST_INFO(errors, outcome.errors);
  TEST_ASSERT_EQUAL_INT32(0, outcome.exit_code);
  TEST_ASSERT_TRUE(outcome.errors.empty());
  Json object = Json::parse(outcome.output);  // throws on anything after it
  TEST_ASSERT_TRUE(object.is_object());
  return object;
}

inline void check_keys(const Json& object, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    TEST_INFO(key, key);
    TEST_ASSERT_TRUE(object.contains(key));
  }
}

}  // namespace stillpoint::testing

// SPDX-License-Identifier: Apache-2.0
// What a command of the command line refuses.
#pragma once

#include <string>

#include "sim/refusal.hpp"
#include "tests/support/test.hpp"

namespace stillpoint::testing {

// Both empty where nothing was refused.
struct SeenRefusal {
  std::string said;
  std::string result;
};

template <typename Ask>
SeenRefusal refusal_of(const Ask& ask) {
  try {
    ask();
  } catch (const sim::Refusal& refusal) {
    return {refusal.what(), refusal.result()};
  }
  return {};
}

inline void check_says(const std::string& expected, const std::string& said) {
  TEST_INFO("expected", expected);
  TEST_INFO("said", said);
  TEST_ASSERT_TRUE(said.find(expected) != std::string::npos);
}

}  // namespace stillpoint::testing

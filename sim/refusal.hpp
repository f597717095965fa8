// SPDX-License-Identifier: Apache-2.0
// Why something was not done, in the one line a person reads: WHAT: VALUE: WHY, what would be accepted.
#pragma once

#include <stdexcept>
#include <string>

#include "shaper/base/status.hpp"

namespace stillpoint::sim {

class Refusal : public std::runtime_error {
 public:
  enum class Cause { kCannot = 1, kBadArgument = 2 };  // as exit codes

  Refusal(Cause cause, const std::string& what, const std::string& value, const std::string& why,
          const std::string& result = "refused");

  int exit_code() const { return static_cast<int>(cause_); }
  // The cause as one word, for `"result"` in JSON.
  const std::string& result() const { return result_; }

  // The same, with what has come of it.
  Refusal with(const std::string& more) const { return Refusal(cause_, what() + more, result_); }

 private:
  Refusal(Cause cause, const std::string& line, const std::string& result)
      : std::runtime_error(line), cause_(cause), result_(result) {}

  Cause cause_;
  std::string result_;
};

Refusal bad_argument(const std::string& what, const std::string& value, const std::string& why);

// A refusal of the core. Positions and their derivatives are counts there: they are divided by `counts_per_unit`.
// kLimitExceeded is "could not be done", everything else a bad argument.
Refusal refusal_from(const Status& status, double counts_per_unit);

// Throws refusal_from() unless `status` is a success.
void require(const Status& status, double counts_per_unit = 1.0);

}  // namespace stillpoint::sim

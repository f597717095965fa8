// SPDX-License-Identifier: Apache-2.0
// Runs the built command line as a person would.
#pragma once

#include <string>

namespace stillpoint::testing {

struct Outcome {
  int exit_code;
  std::string output;
  std::string errors;
};

// `arguments` as a shell takes them; `input` on standard input. In a folder of this process's own.
Outcome run_program(const std::string& arguments, const std::string& input = "");

// A file of that folder.
std::string scratch_file(const std::string& name);
std::string read_text(const std::string& path);

}  // namespace stillpoint::testing

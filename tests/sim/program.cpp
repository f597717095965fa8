// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/program.hpp"

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace stillpoint::testing {
namespace {

// Gone with the process.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "stillpoint-test-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no scratch folder");
    path_ = pattern;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

std::string scratch_file(const std::string& name) {
  static const ScratchFolder folder;
  return folder.path() + "/" + name;
}

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

Outcome run_program(const std::string& arguments, const std::string& input) {
  const std::string in = scratch_file("in");
  const std::string out = scratch_file("out");
  const std::string err = scratch_file("err");
  std::ofstream(in, std::ios::binary) << input;
  const std::string command =
      std::string("'") + STILLPOINT_PROGRAM + "' " + arguments + " <'" + in + "' >'" + out + "' 2>'" + err + "'";
  const int status = std::system(command.c_str());
  if (!WIFEXITED(status)) throw std::runtime_error("did not exit: " + command);
  return Outcome{WEXITSTATUS(status), read_text(out), read_text(err)};
}

}  // namespace stillpoint::testing

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace stillpoint::cli {

// What the comment lines say: names and values with their units.
using Settings = std::vector<std::pair<std::string, std::string>>;

// `#` lines with the command and its settings, one line of column names, then numbers.
class CsvFile {
 public:
  // Refuses a file that cannot be written.
  CsvFile(const std::string& path, const std::string& command, const Settings& settings,
          const std::vector<std::string>& columns);

  void row(const std::vector<std::string>& cells);
  // Refuses when not everything could be written.
  void close();

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
};

}  // namespace stillpoint::cli

// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/csv.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

sim::Refusal not_written(const std::string& path) {
  return sim::bad_argument(
      "--csv", path, std::string("not written (") + std::strerror(errno) + "), a file that can be written is accepted");
}

}  // namespace

CsvFile::CsvFile(const std::string& path, const std::string& command, const Settings& settings,
                 const std::vector<std::string>& columns)
    : path_(path), file_(std::fopen(path.c_str(), "w")) {
  if (!file_) throw not_written(path);
  fmt::print(file_.get(), "# stillpoint {}\n", command);
  for (const auto& [name, value] : settings) fmt::print(file_.get(), "# {}: {}\n", name, value);
  row(columns);
}

void CsvFile::row(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (!line.empty()) line += ',';
    line += cell;
  }
  line += '\n';
  if (std::fputs(line.c_str(), file_.get()) < 0) throw not_written(path_);
}

void CsvFile::close() {
  if (std::fclose(file_.release()) != 0) throw not_written(path_);
}

}  // namespace stillpoint::cli

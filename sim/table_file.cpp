// SPDX-License-Identifier: Apache-2.0
#include "sim/table_file.hpp"

#include <fstream>
#include <sstream>

#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::sim {
namespace {

constexpr const char* kFirstLine = "stillpoint profile table 1";

// Lines with something on them, and where they are.
class Lines {
 public:
  explicit Lines(const std::string& path) : path_(path), file_(path) {
    if (!file_) throw bad_argument("table", path, "cannot be read, a file of `stillpoint table` is accepted");
  }
  bool next() {
    while (std::getline(file_, line_)) {
      ++number_;
      line_ = trimmed(line_);
      if (!line_.empty() && line_[0] != '#') return true;
    }
    ++number_;
    line_.clear();
    return false;
  }
  const std::string& line() const { return line_; }
  std::string where() const { return path_ + ", line " + std::to_string(number_); }

  // The number behind `name`.
  uint32_t value_of(const std::string& name, uint32_t most) {
    if (!next() || line_.rfind(name + " ", 0) != 0)
      throw bad_argument("table", where(), "no `" + name + " N`, a file of `stillpoint table` is accepted");
    return static_cast<uint32_t>(parse_integer(trimmed(line_.substr(name.size())), where(), 1, most));
  }

 private:
  std::string path_;
  std::ifstream file_;
  std::string line_;
  int number_ = 0;
};

std::ofstream open_for(const std::string& option, const std::string& path) {
  std::ofstream file(path);
  if (!file) throw bad_argument(option, path, "not written, a file that can be written is accepted");
  return file;
}

void close(std::ofstream& file, const std::string& option, const std::string& path) {
  file.close();
  if (!file) throw bad_argument(option, path, "not written, a file that can be written is accepted");
}

}  // namespace

TableData read_table(const std::string& path) {
  Lines lines(path);
  if (!lines.next() || lines.line() != kFirstLine)
    throw bad_argument(
        "table", path,
        std::string("does not begin with `") + kFirstLine + "`, a file of `stillpoint table` is accepted");
  TableData data{};
  data.order = lines.value_of("order", kMaxTableOrder);
  data.spans = lines.value_of("spans", kMaxTableSpans);
  uint32_t knots = 0;
  for (; lines.next(); ++knots) {
    std::istringstream cells(lines.line());
    uint32_t count = 0;
    for (std::string cell; cells >> cell; ++count)
      data.nodes.push_back(parse_integer(cell, lines.where(), -kLargestNode, kLargestNode));
    if (count != data.order + 1)
      throw bad_argument("table", lines.where(),
                         std::to_string(count) + " numbers, " + std::to_string(data.order + 1) + " are accepted");
  }
  if (knots != data.spans + 1)
    throw bad_argument("table", path,
                       std::to_string(knots) + " knots, " + std::to_string(data.spans + 1) + " are accepted");
  data.peaks = peaks_of_nodes(data.table());
  require(data.table().validate());
  return data;
}

void write_table(const std::string& path, const TableData& data, const std::vector<std::string>& comments) {
  std::ofstream file = open_for("--out", path);
  for (const std::string& comment : comments) file << "# " << comment << '\n';
  file << kFirstLine << "\norder " << data.order << "\nspans " << data.spans << '\n';
  for (size_t i = 0; i < data.nodes.size(); ++i) {
    file << data.nodes[i] << ((i + 1) % (data.order + 1) == 0 ? '\n' : ' ');
  }
  close(file, "--out", path);
}

void write_table_header(const std::string& path, const TableData& data, const std::string& name,
                        const std::vector<std::string>& comments) {
  std::ofstream file = open_for("--header", path);
  for (const std::string& comment : comments) file << "// " << comment << '\n';
  file << "#pragma once\n\n#include \"shaper/profile/profile_table.hpp\"\n\nnamespace stillpoint {\n\n"
       << "inline constexpr int64_t " << name << "Nodes[] = {\n";
  for (size_t i = 0; i < data.nodes.size(); ++i) {
    const bool last = (i + 1) % (data.order + 1) == 0;
    file << (i % (data.order + 1) == 0 ? "    " : " ") << "INT64_C(" << data.nodes[i] << ')' << (last ? ",\n" : ",");
  }
  file << "};\ninline constexpr ProfileTable " << name << " = {\n    " << data.order << ", " << data.spans << ", "
       << name << "Nodes, {" << shortest(data.peaks.velocity) << ", " << shortest(data.peaks.acceleration) << ", "
       << shortest(data.peaks.deceleration) << ", " << shortest(data.peaks.jerk)
       << "}};\n\n}  // namespace stillpoint\n";
  close(file, "--header", path);
}

}  // namespace stillpoint::sim

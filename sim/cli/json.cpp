// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/json.hpp"

#include <cstdio>

namespace stillpoint::cli {
namespace {

// nlohmann::json prints every double in its shortest form. Digits to be kept travel as a string between two marks that
// no other string of ours holds; the marks and the quotes around them are taken out of the printed text.
constexpr char kMark[] = "\x01";
constexpr char kOpening[] = "\"\\u0001";
constexpr char kClosing[] = "\\u0001\"";

void erase_all(std::string& text, const std::string& piece) {
  std::string kept;
  size_t start = 0;
  for (size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, start)) {
    kept.append(text, start, at - start);
    start = at + piece.size();
  }
  text = kept.append(text, start, std::string::npos);
}

}  // namespace

Json exact_number(const std::string& decimal) { return kMark + decimal + kMark; }

Json optional_number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

void print_json(const Json& object) {
  std::string text = object.dump(2, ' ', false, Json::error_handler_t::replace);
  erase_all(text, kOpening);
  erase_all(text, kClosing);
  std::printf("%s\n", text.c_str());
}

}  // namespace stillpoint::cli

// SPDX-License-Identifier: Apache-2.0
// Pictures, drawn by gnuplot.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stillpoint::cli {

struct Series {
  std::string label;
  std::string style;  // gnuplot's, e.g. "lines lw 2 lc rgb '#0060ad'"
  std::vector<double> x;
  std::vector<double> y;
};

struct Panel {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::optional<std::pair<double, double>> x_range;
  std::vector<Series> series;
  std::string legend = "right top";
  std::optional<std::pair<double, double>> y_range = {};
};

struct Picture {
  std::string title;
  std::vector<Panel> panels;  // one below the other
};

// Colours that stay apart for most eyes: one for the plain move, one for the shaped.
constexpr char kPlainColour[] = "#d95f02";
constexpr char kShapedColour[] = "#1b6ca8";
std::string line_style(const std::string& colour, double width, bool dashed = false);

// Refuses, before any work is done, a name that ends neither in .svg nor in .png. Empty: no picture wanted.
void check_picture(const std::string& path);

// Refuses when gnuplot is missing or fails.
void draw(const std::string& path, const Picture& picture);

}  // namespace stillpoint::cli

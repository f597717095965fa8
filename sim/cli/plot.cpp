// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/plot.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "sim/refusal.hpp"

namespace stillpoint::cli {
namespace {

constexpr int kWidth = 900;
constexpr int kPanelHeight = 300;

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::string quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return quoted + "'";
}

void append_data(std::string& script, const Series& series, size_t number) {
  script += fmt::format("$s{} << EOD\n", number);
  constexpr size_t kMostPoints = 20000;  // far more than pixels
  const size_t stride = series.x.size() / kMostPoints + 1;
  for (size_t i = 0; i < series.x.size(); i += stride) {
    script += fmt::format("{:.9g} {:.9g}\n", series.x[i], series.y[i]);
  }
  script += "EOD\n";
}

void append_panel(std::string& script, const Panel& panel, size_t& number) {
  std::string plot = "plot ";
  for (const Series& series : panel.series) {
    append_data(script, series, number);
    plot += fmt::format("$s{} with {} title {}, ", number, series.style, quoted(series.label));
    ++number;
  }
  script += fmt::format("set title {}\nset xlabel {}\nset ylabel {}\nset key {}\n", quoted(panel.title),
                        quoted(panel.x_label), quoted(panel.y_label), panel.legend);
  if (panel.x_range) script += fmt::format("set xrange [{}:{}]\n", panel.x_range->first, panel.x_range->second);
  if (panel.y_range) script += fmt::format("set yrange [{}:{}]\n", panel.y_range->first, panel.y_range->second);
  script += plot + "\nset autoscale\n";
}

std::string script_of(const std::string& path, const Picture& picture) {
  const int height = kPanelHeight * static_cast<int>(picture.panels.size()) + 40;
  const char* terminal = ends_with(path, ".svg") ? "svg background 'white' noenhanced" : "pngcairo noenhanced";
  std::string script =
      fmt::format("set terminal {} size {},{} font 'sans,12'\nset output {}\n", terminal, kWidth, height, quoted(path));
  script += "set grid lt 1 lw 1 lc rgb '#dddddd'\nset border lc rgb '#666666'\nset tics nomirror\nset lmargin 12\n";
  script += fmt::format("set multiplot layout {},1 title {}\n", picture.panels.size(), quoted(picture.title));
  size_t number = 0;
  for (const Panel& panel : picture.panels) append_panel(script, panel, number);
  return script + "unset multiplot\nset output\n";
}

// A file for gnuplot to read, gone with the object.
class ScriptFile {
 public:
  explicit ScriptFile(const std::string& text) {
    const char* folder = std::getenv("TMPDIR");
    name_ = std::string(folder != nullptr ? folder : "/tmp") + "/stillpoint-XXXXXX";
    const int file = mkstemp(name_.data());
    if (file < 0) return;
    std::FILE* stream = fdopen(file, "w");
    written_ = std::fputs(text.c_str(), stream) >= 0;
    written_ = std::fclose(stream) == 0 && written_;
  }
  ScriptFile(const ScriptFile&) = delete;
  ScriptFile& operator=(const ScriptFile&) = delete;
  ~ScriptFile() { unlink(name_.c_str()); }

  bool written() const { return written_; }
  std::string& name() { return name_; }

 private:
  std::string name_;
  bool written_ = false;
};

// gnuplot's exit status; 127 where there is none. Its own words stay out of the one-line error.
int run_gnuplot(ScriptFile& script) {
  std::string program = "gnuplot";
  char* const arguments[] = {program.data(), script.name().data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", 1, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", 1, 0);
  pid_t child = 0;
  const int error = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return 127;
  int status = 0;
  if (waitpid(child, &status, 0) != child || !WIFEXITED(status)) return 1;
  return WEXITSTATUS(status);
}

}  // namespace

std::string line_style(const std::string& colour, double width, bool dashed) {
  return fmt::format("lines lw {} lc rgb '{}'{}", width, colour, dashed ? " dt '-'" : "");
}

void check_picture(const std::string& path) {
  if (path.empty() || ends_with(path, ".svg") || ends_with(path, ".png")) return;
  throw sim::bad_argument("--plot", path, "not a kind of picture that can be drawn, FILE.svg or FILE.png is accepted");
}

void draw(const std::string& path, const Picture& picture) {
  check_picture(path);
  std::FILE* writable = std::fopen(path.c_str(), "w");
  if (writable == nullptr) throw sim::bad_argument("--plot", path, "cannot be written, a file that can be is accepted");
  std::fclose(writable);
  ScriptFile script(script_of(path, picture));
  const int status = script.written() ? run_gnuplot(script) : 1;
  if (status == 0) return;
  const char* why = status == 127 ? "gnuplot was not found, it is accepted once the package gnuplot-nox is installed"
                                  : "gnuplot could not draw it, a file and a /tmp that can be written are accepted";
  throw sim::Refusal(sim::Refusal::Cause::kCannot, "--plot", path, why, "no_picture");
}

}  // namespace stillpoint::cli

// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/scope_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "firmware/registers.hpp"
#include "sim/cli/table.hpp"
#include "sim/record_table.hpp"
#include "sim/refusal.hpp"
#include "sim/text.hpp"

namespace stillpoint::cli {
namespace {

struct Channel {
  const char* name;
  const char* axis;  // what panel it is drawn in
};
constexpr Channel kChannels[] = {{"demand", "position [counts]"},
                                 {"setpoint", "position [counts]"},
                                 {"position", "position [counts]"},
                                 {"following-error", "following error [counts]"},
                                 {"demand-velocity", "velocity [counts/s]"},
                                 {"setpoint-velocity", "velocity [counts/s]"},
                                 {"velocity", "velocity [counts/s]"},
                                 {"accelerometer", "accelerometer [raw steps]"},
                                 {"phase", "phase"},
                                 {"fault", "fault code"},
                                 {"flags", "flags"}};
static_assert(std::size(kChannels) + 1 == firmware::kScopeSources, "the drive's, but for none");

const char* const kColours[] = {kPlainColour, kShapedColour, "#1b9e77", "#7570b3"};

std::string axis_of(const std::string& name) {
  for (const Channel& channel : kChannels) {
    if (name == channel.name) return channel.axis;
  }
  return name;
}

std::string plain(const Json& value) { return fmt::format("{:.10g}", value.get<double>()); }

Series trigger_line(const Panel& panel) {
  double low = 0.0;
  double high = 0.0;
  for (const Series& series : panel.series) {
    const auto [least, most] = std::minmax_element(series.y.begin(), series.y.end());
    const bool first = &series == &panel.series.front();
    low = first ? *least : std::min(low, *least);
    high = first ? *most : std::max(high, *most);
  }
  return {"trigger", line_style("#888888", 1, true), {0.0, 0.0}, {low, high}};
}

}  // namespace

uint16_t scope_channel_named(const std::string& name) {
  for (size_t i = 0; i < std::size(kChannels); ++i) {
    if (name == kChannels[i].name) return static_cast<uint16_t>(i + 1);
  }
  throw sim::bad_argument("--channels", name, fmt::format("not known, accepted: {}", kScopeChannels));
}

const char* scope_channel_name(uint16_t source) {
  return source >= 1 && source <= std::size(kChannels) ? kChannels[source - 1].name : "unknown";
}

void write_scope_csv(const std::string& path, const Settings& settings, const ScopeRecord& record) {
  std::vector<std::string> columns = {"time_s"};
  columns.insert(columns.end(), record.names.begin(), record.names.end());
  CsvFile csv(path, "scope", settings, columns);
  for (size_t n = 0; n < record.time_s.size(); ++n) {
    std::vector<std::string> cells = {sim::shortest(record.time_s[n])};
    for (const std::vector<double>& channel : record.channels) cells.push_back(sim::shortest(channel[n]));
    csv.row(cells);
  }
  csv.close();
}

ScopeRecord read_scope_csv(const std::string& path) {
  const sim::RecordTable table = sim::read_record_table(path);
  if (table.columns.size() < 2) {
    throw sim::bad_argument("FILE", path, "has one column, a time in s and what is to be drawn over it are accepted");
  }
  ScopeRecord record;
  record.time_s = table.columns[0];
  record.channels.assign(table.columns.begin() + 1, table.columns.end());
  for (size_t k = 1; k < table.columns.size(); ++k) {
    record.names.push_back(table.names.empty() ? fmt::format("column {}", k) : table.names[k]);
  }
  return record;
}

void draw_scope(const std::string& path, const std::string& title, const ScopeRecord& record) {
  Picture picture{title, {}};
  for (size_t k = 0; k < record.names.size(); ++k) {
    const std::string axis = axis_of(record.names[k]);
    const auto same = [&](const Panel& panel) { return panel.y_label == axis; };
    auto panel = std::find_if(picture.panels.begin(), picture.panels.end(), same);
    if (panel == picture.panels.end()) {
      const std::pair<double, double> whole = {record.time_s.front(), record.time_s.back()};
      picture.panels.push_back(Panel{"", "time after the trigger [s]", axis, whole, {}});
      panel = picture.panels.end() - 1;
    }
    const std::string colour = kColours[k % std::size(kColours)];
    panel->series.push_back({record.names[k], line_style(colour, 1.5), record.time_s, record.channels[k]});
  }
  for (Panel& panel : picture.panels) panel.series.push_back(trigger_line(panel));
  draw(path, picture);
}

Json json_of(const ScopeRecord& record) {
  Json channels = Json::array();
  for (size_t k = 0; k < record.names.size(); ++k) {
    const std::vector<double>& values = record.channels[k];
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    channels.push_back({{"name", record.names[k]}, {"least", *least}, {"most", *most}, {"last", values.back()}});
  }
  return {{"result", "ok"},
          {"samples", record.time_s.size()},
          {"first_s", record.time_s.front()},
          {"last_s", record.time_s.back()},
          {"channels", channels}};
}

void print_scope(const ScopeRecord& record) {
  fmt::print("{} samples from {} to {} s, the trigger at 0\n\n", record.time_s.size(), figure(record.time_s.front()),
             figure(record.time_s.back()));
  const Json object = json_of(record);
  Table table({"channel", "least", "most", "last"});
  for (const Json& channel : object["channels"]) {
    table.row(
        {channel["name"].get<std::string>(), plain(channel["least"]), plain(channel["most"]), plain(channel["last"])});
  }
  table.print();
}

}  // namespace stillpoint::cli

// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/columns/readings.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/times/row_sink.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

constexpr std::size_t kMostWays = 4;    // limit for messages
constexpr std::size_t kMostShown = 16;  // columns; limit for messages
constexpr double kMostInterval = 1.5;   // of an increment, in steps of the rows, which are uneven

std::string capture_name(const RateCandidate& column) {
  return of_axis(column.reference ? "reference_rate" : "rate", column.axis) + "_radps";
}

// temperature_degC for "Temp (degF)": first unit of the quantity; "" for an unknown unit.
std::string channel_name(const std::string& text, const std::string& unit) {
  const std::string known = other_units(unit);
  if (known.empty() || text.empty() || time_unit(unit) || angle_unit(unit, true, false)) return "";
  return text + "_" + known.substr(0, known.find(','));
}

// Adds all other columns with known units, and the references of the axes.
void add_others(const TableSample& table, const Rates& rates, std::vector<CsvColumn>& columns) {
  const auto is_named = [&](const std::string& name) {
    return std::ranges::any_of(columns, [&](const CsvColumn& c) { return c.name == name; });
  };
  const auto add = [&](const std::string& name, const TableColumn& column) {
    if (name.empty() || is_named(name) ||
        std::ranges::any_of(columns, [&](const CsvColumn& c) { return c.header == column.header; }))
      return;
    columns.push_back({name, column.header, column.unit});
  };
  for (Rates& choice : sensors_of(table, {}, true)) {
    // A table that turns a sensor of one axis.
    if (choice.size() == 1 && rates.size() == 1) choice[0].axis = rates[0].axis;
    for (const RateCandidate& truth : choice)
      if (truth.units.size() == 1 &&
          std::ranges::any_of(rates, [&](const RateCandidate& rate) { return rate.axis == truth.axis; }))
        add(capture_name(truth), table.columns[truth.place]);
  }
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const TableColumn& column = table.columns[i];
    const std::string& text = column.words.text;
    const std::string name = channel_name(text, column.unit);
    // Of two with one name and quantity the second has its column's number.
    add(is_named(name) ? channel_name(text + "_" + std::to_string(i + 1), column.unit) : name, column);
  }
}

TableReading reading_by(const TableSample& table, const CsvLayout& asked, const std::optional<CsvTime>& time,
                        const Rates& rates) {
  TableReading way{asked, true, ""};
  const auto add = [&way](const std::string& option) {
    way.options += (way.options.empty() ? "" : " ") + option;
  };
  if (time) {
    way.layout.time = time;
    if (time->header != "time_s") add(option_for(*time));
  } else if (asked.sample_rate_hz) {
    add("--sample-rate " + shortest(*asked.sample_rate_hz));
  } else if (asked.time) {
    if (asked.time->header != "time_s" || !asked.time->unit.empty()) add(option_for(*asked.time));
  } else {
    const auto stated = stated_rate_hz(table.comments);
    way.clear = false;
    add("--sample-rate " + (stated ? shortest(*stated) : "HZ"));
  }
  std::vector<CsvColumn>& columns = way.layout.columns;
  std::size_t shown = columns.size();
  if (columns.empty()) {
    for (const RateCandidate& rate : rates)
      columns.push_back(
          {capture_name(rate), table.columns[rate.place].header, rate.units.front(), rate.scale});
    shown = columns.size();
    add_others(table, rates, columns);
    // Limits the line; the user can ask for more columns.
    if (columns.size() <= kMostShown) shown = columns.size();
    // Not shown, because its unit is that of rows whose time is chosen.
    if (const auto interval = interval_of(table, way.layout)) columns.push_back(*interval);
  }
  for (std::size_t i = 0; i < shown; ++i) add(option_for(columns[i], columns[i].unit));
  return way;
}

// "; in the place of rad/s: deg/s, rad/sample": alternatives.
std::string instead_of(const std::vector<std::string>& units) {
  std::string text;
  for (std::size_t i = 1; i < units.size(); ++i) text += (i > 1 ? ", " : "") + units[i];
  return text.empty() ? "" : "; in the place of " + units.front() + ": " + text;
}

// The chosen columns, or each sensor of which these may be the rates.
std::vector<Rates> sensors_asked_for(const TableSample& table, const CsvLayout& asked) {
  if (asked.columns.empty()) {
    std::optional<CsvTime> time = asked.time;
    if (const auto times = times_of(table, {}); !time && !times.empty()) time = times[0].time;
    return sensors_of(table, time);
  }
  Rates chosen;
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    for (const CsvColumn& column : asked.columns)
      if (column.is_rate() && column.header == table.columns[i].header) chosen.push_back({i, "", {"rad/s"}});
  return {chosen};
}

}  // namespace

Readings readings_of(const TableSample& table, const CsvLayout& asked) {
  Readings out;
  const bool any_time = asked.time || asked.sample_rate_hz;
  std::vector<Rates> sensors = sensors_asked_for(table, asked);
  if (sensors.empty()) {
    out.why = "no column is named as a gyro's rate";
    return out;
  }
  const Rates& first = sensors.front();
  const bool angle = !first.empty() && first[0].units.size() > 1;  // by its name
  std::string time_units, rate_units, ticks;                       // alternatives, if unknown
  bool counts = false;
  std::size_t time_columns = 0;
  for (Rates& sensor : sensors) {
    settle_units(table, sensor);
    const auto open = std::ranges::find_if(sensor, [](const auto& rate) { return rate.units.size() > 1; });
    if (open != sensor.end()) {
      if (rate_units.empty()) rate_units = instead_of(open->units);
      counts = counts || std::ranges::all_of(sensor, [&](const RateCandidate& rate) {
                 return table.columns[rate.place].are_counts();
               });
    }
    std::vector<std::optional<CsvTime>> times;
    if (!any_time)
      for (TimeCandidate& found : times_of(table, sensor)) {
        if (found.units.size() > 1) time_units = instead_of(found.units), ticks = found.time.remark;
        found.time.unit = found.units.front();
        times.emplace_back(found.time);
      }
    time_columns = std::max(time_columns, times.size());
    if (times.empty()) times.emplace_back();
    for (const auto& time : times)
      if (out.ways.size() < kMostWays) out.ways.push_back(reading_by(table, asked, time, sensor));
  }
  out.other_units = time_units + rate_units;
  out.ways.front().clear = out.ways.front().clear && out.other_units.empty();
  if (time_columns == 0 && !any_time) {
    const std::string counted = table.counting();
    out.why =
        counted.empty() ? "no time column" : "no time column, " + in_quotes(counted) + " counts the rows";
  } else if (out.ways.size() > 1) {
    out.why = "more than one column may be the " + std::string(time_columns > 1 ? "time" : "rate");
  } else if (!time_units.empty() || (!rate_units.empty() && !angle)) {
    out.why =
        "the unit of the " + std::string(time_units.empty() ? "rate" : "time") + " is not named" + ticks;
  } else if (!rate_units.empty()) {
    out.why = in_quotes(table.columns[first[0].place].header) +
              " has a unit of angle, as a rate, an angle or the turn in each sample may";
  }
  if (counts)
    out.why += "; whole numbers are often counts, whose scale is in the sensor's manual: --column " +
               shell_word(capture_name(first.back()) + "=" + table.columns[first.back().place].header +
                          (first.back().increment ? ":1e-9rad/sample" : ":0.005deg/s"));
  return out;
}

std::vector<CsvColumn> rates_not_chosen(const TableSample& table, const CsvLayout& chosen) {
  if (!table.named) return {};
  for (const Rates& sensor : sensors_of(table, {})) {
    const CsvColumn* sibling = nullptr;
    std::vector<CsvColumn> others;
    for (const RateCandidate& rate : sensor) {
      const std::string& header = table.columns[rate.place].header;
      const std::string number = "#" + std::to_string(rate.place + 1);
      const auto is_here = [&](const std::string& wanted) { return wanted == header || wanted == number; };
      const auto same = std::ranges::find_if(
          chosen.columns, [&](const CsvColumn& c) { return c.is_rate() && is_here(c.header); });
      if (same != chosen.columns.end())
        sibling = &*same;
      else if (!chosen.time || !is_here(chosen.time->header))
        others.push_back({"other_" + capture_name(rate), header, ""});
    }
    if (sibling == nullptr) continue;
    for (CsvColumn& other : others) {
      other.unit = sibling->unit.empty() ? "rad/s" : sibling->unit;
      other.scale = sibling->scale;
    }
    return others;
  }
  return {};
}

std::optional<CsvColumn> interval_of(const TableSample& table, const CsvLayout& layout) {
  const auto column_of = [&](const std::string& header) -> const TableColumn* {
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      if (table.columns[i].header == header || header == "#" + std::to_string(i + 1))
        return &table.columns[i];
    return nullptr;
  };
  const TableColumn* increment = nullptr;
  for (const CsvColumn& chosen : layout.columns) {
    if (chosen.name == kInterval) return std::nullopt;
    if (increment == nullptr && chosen.unit.ends_with("/sample") && chosen.angle_rad())
      increment = column_of(chosen.header);
  }
  if (increment == nullptr) return std::nullopt;
  double rows_s = layout.sample_rate_hz ? 1.0 / *layout.sample_rate_hz : HUGE_VAL;
  const TableColumn* const time = layout.time ? column_of(layout.time->header) : nullptr;
  if (time != nullptr && time->values.size() > 1)
    rows_s = median_step_s(time->values) * layout.time->unit_s();
  const Words& turned = increment->words;
  for (const TableColumn& column : table.columns) {
    const Words& words = column.words;
    // ArduPilot's IMT has DelaT for DelAX.
    const bool named =
        (turned.text.size() > 2 && words.text == turned.text.substr(0, turned.text.size() - 1) + "t") ||
        ((words.has("dt") || words.has("interval")) &&
         std::ranges::all_of(words.words, [&](const std::string& word) {
           return word == "dt" || word == "interval" || turned.has(word);
         }));
    if (!named || column.values.empty()) continue;
    std::vector<std::string> units{"s", "ms", "us", "ns"};
    if (time_unit(column.unit)) units = {column.unit};
    for (const std::string& unit : units)
      if (median(column.values) * CsvTime{"", unit}.unit_s() < kMostInterval * rows_s)
        return CsvColumn{kInterval, column.header, unit};
  }
  return std::nullopt;
}

std::string in_words(const CsvLayout& layout) {
  std::string text;
  if (layout.sample_rate_hz) text = "rows " + shortest(*layout.sample_rate_hz) + " Hz apart";
  if (layout.time)
    text = "time " + in_quotes(layout.time->header) + " in " +
           (layout.time->unit.empty() ? "s" : printable(layout.time->unit)) + layout.time->remark;
  for (const CsvColumn& column : layout.columns) {
    text += (text.empty() ? "" : ", ") + column.name.substr(0, column.name.rfind('_')) + " " +
            in_quotes(column.header) + " in " + (column.scale == 1.0 ? "" : shortest(column.scale) + " ") +
            printable(column.unit.empty() ? column.own_unit() : column.unit);
    if (column.angle_rad() && !column.unit.ends_with("/sample")) text += " (an angle, by its differences)";
  }
  return text;
}

}  // namespace ifog

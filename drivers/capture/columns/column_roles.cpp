// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/columns/column_roles.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

constexpr std::size_t kMostWays = 4;    // limit for messages
constexpr std::size_t kMostShown = 16;  // columns; limit for messages

// By sensor: columns whose names differ only in the axis.
using Sensors = std::map<std::string, std::vector<RateCandidate>>;

// Turn within a sample: delta_angle, dtheta.
bool speaks_of_increment(const Words& words) {
  return words.has("dtheta") || words.has("dangle") || words.has("dang") ||
         (words.have(Role::step) && words.have(Role::angle));
}

bool speaks_of_rate(const Words& words) {
  return words.have(Role::rate) || (words.have(Role::speed) && words.have(Role::turn)) ||
         (words.first() == "rate" && !words.has("hz")) || (words.first() == "raw" && words.size() <= 2) ||
         // wz; w_RS_S_x of kalibr; gx, gx2, g_x, IMU_gx.
         (!words.axis.empty() &&
          (words.first() == "w" ||
           (words.first() == "g" &&
            (words.size() == 1 || std::isdigit(static_cast<unsigned char>(words.words[1][0])) != 0)) ||
           words.text.ends_with("_g" + words.axis)));
}

// Sets the unit of a rate by name or convention, or the possible ones: a bare unit of angle leaves open of what it is.
void set_unit(RateCandidate& rate, const Words& words, const std::string& unit) {
  if (unit.empty()) {
    // sensor_msgs/Imu of ROS: rad/s; vehicle_imu of PX4: rad per sample.
    if (words.has("angular") && words.has("velocity")) rate.unit = "rad/s";
    if (rate.increment && words.has("delta") && words.has("angle")) rate.unit = "rad/sample";
  } else if (angle_unit(unit, true, false)) {
    rate.unit = unit;
  } else if (rate.increment) {
    rate.unit = unit + "/sample";
  } else if (words.text == "gyro_rad" && !words.axis.empty()) {  // sensor_combined of PX4
    rate.unit = "rad/s";
  } else {
    rate.units = {unit + "/s", unit, unit + "/sample"};
  }
}

// A rate column without its place, or nullopt. angles: one that is named as an angle instead.
std::optional<RateCandidate> candidate_of(const Words& words, const std::string& unit, bool angles) {
  if (words.have(Role::no_rate)) return std::nullopt;
  const bool rate = angle_unit(unit, true, false).has_value(),
             angle = angle_unit(unit, false, false).has_value(), gyro = speaks_of_rate(words);
  if (!unit.empty() && !rate && !angle) return std::nullopt;
  RateCandidate found{
      .axis = words.axis, .reference = words.have(Role::truth), .increment = speaks_of_increment(words)};
  const bool turned = angle && words.have(Role::angle) && !words.have(Role::speed) && !found.increment;
  if (angles) {
    if (!angle || (!turned && !(words.has("turn") && words.axis == "z"))) return std::nullopt;
    if (turned && (gyro || found.reference))
      found.unit = unit;
    else
      found.units = {unit, unit + "/s", unit + "/sample"};
    return found;
  }
  const bool likely = !words.axis.empty() || found.reference || words.has("rate") || words.size() == 0;
  if (!gyro && !found.increment && !(rate && likely)) return std::nullopt;
  if (turned) return std::nullopt;
  set_unit(found, words, unit);
  return found;
}

// p, q and r are body rates; x, y and z alone are the axes of a file with a single sensor, e.g. of a phone.
// Next to w or qw they are a quaternion or position.
void add_triple(const TableSample& table, Sensors& sensors) {
  if (!sensors.empty()) return;
  std::vector<RateCandidate> body, bare;
  bool attitude = false;
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const Words words(table.names[i]);
    const std::string unit = table.unit_of(i);
    attitude = attitude || words.text == "w" || words.text == "qw" || words.text == "q_w";
    if (words.text.size() == 1 && words.text >= "p" && words.text <= "r" &&
        (unit.empty() || angle_unit(unit, true, true))) {
      body.push_back({i, "", std::string(1, static_cast<char>('x' + (words.text[0] - 'p')))});
      set_unit(body.back(), words, unit);
    }
    const bool nameless = words.size() == 0 || words.text == "xyz";  // "xyz[0]" of PX4
    if (nameless && !words.axis.empty() && unit.empty()) bare.push_back({i, "", words.axis});
  }
  if (body.size() == 3)
    sensors["p q r"] = body;
  else if (bare.size() == 3 && !attitude && !is_gravity(table, bare))
    sensors["x y z"] = bare;
}

// angles: columns that are named as angles, which are used where no rate is.
Sensors sensors_of(const TableSample& table, bool references, bool angles = false) {
  Sensors sensors;
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const Words words(table.names[i]);
    auto found = candidate_of(words, table.unit_of(i), angles);
    if (!found || found->reference != references || is_empty(table.cells[i])) continue;
    found->place = i;
    if (words.has("minus")) found->scale = -1.0;
    sensors[words.stem].push_back(*found);
  }
  // Three columns of the same name (a header that spans three cells) are axes.
  for (auto& [stem, columns] : sensors)
    if (columns.size() == 3 && columns[0].axis.empty() &&
        std::ranges::all_of(columns, [&, &first = columns[0]](const RateCandidate& column) {
          return table.names[column.place] == table.names[first.place];
        }))
      for (std::size_t i = 0; i < 3; ++i) columns[i].axis = std::string(1, static_cast<char>('x' + i));
  if (!references) add_triple(table, sensors);
  return sensors.empty() && !angles ? sensors_of(table, references, true) : sensors;
}

bool axes_differ(const std::vector<RateCandidate>& columns) {
  std::set<std::string> axes;
  for (const RateCandidate& column : columns) axes.insert(column.axis);
  return axes.size() == columns.size();
}

// Possible sensors: the one with the most axes, or all with that number.
std::vector<std::vector<RateCandidate>> choices_of(const Sensors& sensors) {
  std::vector<RateCandidate> together;
  std::size_t most = 0;
  bool named_axes = false;
  for (const auto& [stem, columns] : sensors) {
    most = std::max(most, columns.size());
    for (const RateCandidate& column : columns) named_axes = named_axes || !column.axis.empty();
    together.insert(together.end(), columns.begin(), columns.end());
  }
  // "norm of the rate" next to three axes is no axis.
  if (named_axes) std::erase_if(together, [](const RateCandidate& column) { return column.axis.empty(); });
  if (together.empty()) return {};
  std::ranges::sort(together, {}, &RateCandidate::place);
  if (axes_differ(together)) return {together};
  std::vector<std::vector<RateCandidate>> choices;
  for (const auto& [stem, columns] : sensors) {
    if (columns.size() != most) continue;
    if (axes_differ(columns)) {
      choices.push_back(columns);
      continue;
    }
    for (const RateCandidate& column : columns) choices.push_back({column});
  }
  std::ranges::sort(choices, [](const auto& a, const auto& b) { return a[0].place < b[0].place; });
  return choices;
}

std::string capture_name(const RateCandidate& column) {
  return std::string(column.reference ? "reference_rate" : "rate") +
         (column.axis.empty() ? "" : "_" + column.axis) + "_radps";
}

// temperature_degC for "Temp (degF)": first unit of the quantity; "" for an unknown unit.
std::string channel_name(const Words& words, const std::string& unit) {
  const std::string known = other_units(unit);
  if (known.empty() || words.text.empty() || time_unit(unit) || angle_unit(unit, true, false)) return "";
  return words.text + "_" + known.substr(0, known.find(','));
}

// Adds all other columns with known units, and the references of the axes.
void add_others(const TableSample& table, const std::vector<RateCandidate>& rates,
                std::vector<CsvColumn>& columns) {
  const auto add = [&](const std::string& name, std::size_t place, const std::string& unit) {
    const std::string header = table.header_of(place);
    const auto listed = [&](const CsvColumn& c) { return c.name == name || c.header == header; };
    if (!name.empty() && std::ranges::none_of(columns, listed)) columns.push_back({name, header, unit});
  };
  for (auto& choice : choices_of(sensors_of(table, true))) {
    // A table that turns a sensor of one axis.
    if (choice.size() == 1 && rates.size() == 1) choice[0].axis = rates[0].axis;
    for (const RateCandidate& column : choice)
      if (!column.unit.empty() &&
          std::ranges::any_of(rates, [&](const RateCandidate& r) { return r.axis == column.axis; }))
        add(capture_name(column), column.place, column.unit);
  }
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    Words words(table.names[i]);
    const std::string unit = table.unit_of(i), name = channel_name(words, unit);
    // Of two with one name and quantity the second has its column's number.
    if (std::ranges::any_of(columns, [&](const CsvColumn& column) { return column.name == name; }))
      words.text += "_" + std::to_string(i + 1);
    add(channel_name(words, unit), i, unit);
  }
}

TableReading reading_by(const TableSample& table, const CsvLayout& asked, const std::optional<CsvTime>& time,
                        const std::vector<RateCandidate>& rates) {
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
  if (!asked.columns.empty()) {
    for (const CsvColumn& column : asked.columns) add(option_for(column, column.unit));
    return way;
  }
  for (const RateCandidate& rate : rates) {
    way.layout.columns.push_back({capture_name(rate), table.header_of(rate.place), rate.unit, rate.scale});
  }
  const std::size_t rates_only = way.layout.columns.size();
  add_others(table, rates, way.layout.columns);
  // Limits the line; the user can ask for more columns.
  const std::size_t shown = way.layout.columns.size() > kMostShown ? rates_only : way.layout.columns.size();
  for (std::size_t i = 0; i < shown; ++i) add(option_for(way.layout.columns[i], way.layout.columns[i].unit));
  return way;
}

// "; in the place of rad/s: deg/s, rad/sample": alternatives.
std::string instead_of(const std::vector<std::string>& units) {
  if (units.size() < 2) return "";
  std::string text = "; in the place of " + units.front() + ": ";
  for (std::size_t i = 1; i < units.size(); ++i) text += (i > 1 ? ", " : "") + units[i];
  return text;
}

bool is_unit_unknown(const RateCandidate& rate) { return rate.unit.empty(); }

// The chosen columns, or each sensor of which these may be the rates.
std::vector<Rates> sensors_asked_for(const TableSample& table, const CsvLayout& asked) {
  std::vector<Rates> sensors(1);
  if (!asked.columns.empty()) {
    for (std::size_t i = 0; i < table.names.size(); ++i)
      for (const CsvColumn& column : asked.columns)
        if (column.is_rate() && column.header == table.header_of(i)) sensors[0].push_back({i, "rad/s", ""});
    return sensors;
  }
  std::optional<CsvTime> time = asked.time;
  if (const auto times = times_of(table, {}); !time && !times.empty()) time = times[0];
  sensors = table.named ? choices_of(sensors_of(table, false)) : rates_by_place(table, time);
  std::erase_if(sensors, [](const Rates& each) { return each.empty(); });
  return sensors;
}

}  // namespace

std::string typed(const std::string& unit) {
  if (printable(unit, unit.size()) == unit) return unit;
  for (const char* const known : {"deg/s", "rad/s", "deg", "deg/h", "degC", "s", "us"}) {
    const auto by = convert_unit(unit, known);
    const auto angle = angle_unit(unit, false, false);
    if ((by && by->scale == 1.0 && by->offset == 0.0) || (angle && angle == angle_unit(known, false, false)))
      return known;
  }
  return unit;
}

std::string TableSample::header_of(std::size_t place) const {
  const std::string& name = names[place];
  const bool alone = !name.empty() && std::ranges::count(names, name) == 1;
  return alone && printable(name, name.size()) == name ? name : "#" + std::to_string(place + 1);
}

std::string TableSample::unit_of(std::size_t place) const {
  if (const std::string given = stated_unit(place); !given.empty()) return typed(given);
  const std::string& text = Words(names[place]).text;  // gyro_rad[0]
  if (const std::string unit = unit_in_name(names[place]); !unit.empty())
    // A magnetometer's G is gauss, not gravity.
    return text.starts_with("mag") && (unit == "G" || unit == "mG") ? (unit == "G" ? "gauss" : "mgauss")
                                                                    : typed(unit);
  const std::string last = text.substr(text.rfind('_') + 1);
  return angle_unit(last, false, false) ? last : "";
}

Readings readings_of(const TableSample& table, const CsvLayout& asked) {
  Readings out;
  const bool any_time = asked.time || asked.sample_rate_hz;
  std::vector<Rates> sensors = sensors_asked_for(table, asked);
  if (sensors.empty()) {
    out.why = "no column is named as a gyro's rate";
    return out;
  }
  std::string time_units, rate_units;  // alternatives, if unknown
  bool counts = false;
  std::size_t time_columns = 0;
  const CsvColumn scale = stated_scale(table.comments);
  for (Rates& sensor : sensors) {
    if (!scale.unit.empty() && are_counts(table, sensor))
      for (RateCandidate& rate : sensor)
        if (is_unit_unknown(rate)) rate.unit = scale.unit, rate.scale = scale.scale;
    if (std::ranges::any_of(sensor, is_unit_unknown)) {
      const std::vector<std::string> units = units_of(table, sensor);
      counts = counts || are_counts(table, sensor);
      if (rate_units.empty()) rate_units = instead_of(units);
      for (RateCandidate& rate : sensor)
        if (is_unit_unknown(rate)) rate.unit = units.front();
    }
    std::vector<std::optional<CsvTime>> times;
    if (!any_time)
      for (const CsvTime& time : times_of(table, sensor)) times.emplace_back(time);
    time_columns = std::max(time_columns, times.size());
    if (times.empty()) times.emplace_back();
    for (auto& time : times) {
      if (time && time->unit.empty()) {
        const std::vector<std::string> units = units_of(table, *time);
        time->unit = units.front();
        time_units = instead_of(units);
      }
      if (out.ways.size() < kMostWays) out.ways.push_back(reading_by(table, asked, time, sensor));
    }
  }
  out.other_units = time_units + rate_units;
  out.ways.front().clear = out.ways.front().clear && out.other_units.empty();
  if (time_columns == 0 && !any_time) {
    const std::string counted = counting_column(table);
    out.why =
        counted.empty() ? "no time column" : "no time column, " + in_quotes(counted) + " counts the rows";
  } else if (out.ways.size() > 1) {
    out.why = "more than one column may be the " + std::string(time_columns > 1 ? "time" : "rate");
  } else if (!out.other_units.empty()) {
    out.why = "the unit of the " + std::string(time_units.empty() ? "rate" : "time") + " is not named";
    if (const Rates& rates = sensors[0]; time_units.empty() && !rates.empty() && !rates[0].units.empty())
      out.why = in_quotes(table.header_of(rates[0].place)) +
                " has a unit of angle, as a rate, an angle or the turn in each sample may";
  }
  if (counts)
    out.why += "; whole numbers are often counts, whose scale is in the sensor's manual: --column " +
               shell_word(capture_name(sensors[0].back()) + "=" + table.header_of(sensors[0].back().place) +
                          (sensors[0].back().increment ? ":1e-9rad/sample" : ":0.005deg/s"));
  return out;
}

std::vector<CsvColumn> rates_not_chosen(const TableSample& table, const CsvLayout& chosen) {
  std::vector<CsvColumn> others;
  if (!table.named) return others;
  for (const Rates& sensor : choices_of(sensors_of(table, false))) {
    const CsvColumn* sibling = nullptr;
    others.clear();
    for (const RateCandidate& rate : sensor) {
      const std::string header = table.header_of(rate.place), number = "#" + std::to_string(rate.place + 1);
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

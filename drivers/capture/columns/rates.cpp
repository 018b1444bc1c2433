// SPDX-License-Identifier: Apache-2.0
// Which columns are rates, and which of them belong to one sensor.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/columns/readings.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

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
           (words.first() == "g" && (words.size() == 1 || is_digit(words.words[1][0]))) ||
           words.text.ends_with("_g" + words.axis)));
}

// By name or convention: a bare unit of angle leaves open of what it is.
std::vector<std::string> units_by_name(const Words& words, const std::string& unit, bool increment) {
  if (unit.empty()) {
    // sensor_msgs/Imu of ROS: rad/s; vehicle_imu of PX4 and IMT of ArduPilot: rad per sample.
    if (increment && words.has("delta") && words.has("angle")) return {"rad/sample"};
    if (words.has("angular") && words.has("velocity")) return {"rad/s"};
    return {};
  }
  if (angle_unit(unit, true, false)) return {unit};
  if (increment) return {unit + "/sample"};
  if (words.text == "gyro_rad" && !words.axis.empty()) return {"rad/s"};  // sensor_combined of PX4
  return {unit + "/s", unit, unit + "/sample"};
}

std::optional<RateCandidate> candidate_of(const TableColumn& column, std::size_t place) {
  const Words& words = column.words;
  const std::string& unit = column.unit;
  if (words.have(Role::no_rate) || column.is_empty()) return std::nullopt;
  const bool rate = angle_unit(unit, true, false).has_value(),
             angle = angle_unit(unit, false, false).has_value(), gyro = speaks_of_rate(words);
  if (!unit.empty() && !rate && !angle) return std::nullopt;
  RateCandidate found{place, words.axis};
  found.reference = words.have(Role::truth);
  found.increment = speaks_of_increment(words);
  if (words.has("minus")) found.scale = -1.0;
  const bool likely = !words.axis.empty() || found.reference || words.has("rate") || words.size() == 0;
  const bool turned = angle && words.have(Role::angle) && !words.have(Role::speed) && !found.increment;
  if (!turned && (gyro || found.increment || (rate && likely))) {
    found.units = units_by_name(words, unit, found.increment);
    return found;
  }
  found.angle = true;
  if (!turned && !(angle && words.has("turn") && words.axis == "z")) return std::nullopt;
  found.units = {unit};
  if (!turned || !(gyro || found.reference))
    found.units.insert(found.units.end(), {unit + "/s", unit + "/sample"});
  return found;
}

// True if columns together have the length of gravity, i.e. are an accelerometer at rest: in m/s², g, mg or
// 16-bit counts with a range of 2, 4, 8 or 16 g.
bool is_gravity(const TableSample& table, const Rates& rates) {
  std::vector<double> lengths(table.columns[rates[0].place].cells.size());
  for (const RateCandidate& rate : rates)
    for (std::size_t row = 0; row < lengths.size(); ++row)
      lengths[row] =
          std::hypot(lengths[row], std::strtod(table.columns[rate.place].cells[row].c_str(), nullptr));
  if (lengths.empty()) return false;
  std::ranges::sort(lengths);
  const auto at = [&](double share) {
    return lengths[static_cast<std::size_t>(share * static_cast<double>(lengths.size() - 1))];
  };
  const double middle = at(0.5);
  constexpr std::array<double, 7> kGravities{9.80665, 1.0, 1000.0, 16384.0, 8192.0, 4096.0, 2048.0};
  return at(0.75) - at(0.25) < 0.05 * middle && std::ranges::any_of(kGravities, [&](double gravity) {
           return std::abs(middle / gravity - 1.0) < 0.05;
         });
}

// p, q and r are body rates, and so are wb_x, wb_y, wb_z; rot0, rot1, rot2 may be. x, y and z alone are the axes of a
// file with a single sensor, e.g. of a phone. Next to w or qw they are a quaternion or position.
Rates triple_of(const TableSample& table) {
  Rates body;
  std::map<std::string, Rates> bare;  // by the name without the axis
  bool attitude = false;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const Words& words = table.columns[i].words;
    const std::string &unit = table.columns[i].unit, &text = words.text;
    attitude = attitude || text == "w" || text.ends_with("qw") || text.ends_with("_w");
    if (text.size() == 1 && text >= "p" && text <= "r" && (unit.empty() || angle_unit(unit, true, true)))
      body.push_back(
          {i, axis_name(static_cast<std::size_t>(text[0] - 'p')), units_by_name(words, unit, false)});
    if (!words.axis.empty() && unit.empty()) bare[words.stem].push_back({i, words.axis});
  }
  if (body.size() == 3) return body;
  for (const char* const stem : {"wb", "rot", "", "xyz"})  // "xyz[0]" of PX4
    if (const Rates& axes = bare[stem];
        axes.size() == 3 && (!attitude || stem[0] == 'w') && !is_gravity(table, axes))
      return axes;
  return {};
}

bool axes_differ(const Rates& columns) {
  std::set<std::string> axes;
  for (const RateCandidate& column : columns) axes.insert(column.axis);
  return axes.size() == columns.size();
}

void name_axes(Rates& three) {
  for (std::size_t i = 0; i < 3; ++i) three[i].axis = axis_name(i);
}

// omega_p, omega_q, omega_r; gyro_fwd, gyro_right, gyro_down: perhaps the axes of one sensor.
bool differ_in_a_word(const TableSample& table, const Rates& three) {
  std::set<std::size_t> places;
  const auto words_of = [&](std::size_t i) { return table.columns[three[i].place].words.words; };
  for (const std::size_t other : {1U, 2U}) {
    const auto one = words_of(0), another = words_of(other);
    for (std::size_t i = 0; i < std::max(one.size(), another.size()); ++i)
      if (i >= one.size() || i >= another.size() || one[i] != another[i]) places.insert(i);
  }
  return places.size() == 1;
}

// Columns whose names differ only in the axis are of one sensor. Returns the one with the most axes, or all with that
// number.
std::vector<Rates> sensors_by_name(const TableSample& table, bool references) {
  Rates together;
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    if (const auto found = candidate_of(table.columns[i], i); found && found->reference == references)
      together.push_back(*found);
  const auto is_angle = [](const RateCandidate& column) { return column.angle; };
  if (!std::ranges::all_of(together, is_angle)) {
    std::erase_if(together, is_angle);
  } else if (Rates triple = references ? Rates() : triple_of(table); !triple.empty()) {
    return {triple};
  }
  std::map<std::string, Rates> sensors;
  for (const RateCandidate& column : together)
    sensors[table.columns[column.place].words.stem].push_back(column);
  // Three columns of the same name (a header that spans three cells) are axes.
  const auto name_of = [&](const RateCandidate& column) { return table.columns[column.place].name; };
  for (auto& [stem, columns] : sensors)
    if (columns.size() == 3 && columns[0].axis.empty() &&
        std::ranges::all_of(
            columns, [&, name = name_of(columns[0])](const auto& each) { return name_of(each) == name; }))
      name_axes(columns);
  together.clear();
  std::size_t most = 0;
  for (const auto& [stem, columns] : sensors) {
    most = std::max(most, columns.size());
    together.insert(together.end(), columns.begin(), columns.end());
  }
  // "norm of the rate" next to three axes is no axis.
  const auto has_no_axis = [](const RateCandidate& column) { return column.axis.empty(); };
  if (!std::ranges::all_of(together, has_no_axis)) std::erase_if(together, has_no_axis);
  if (together.empty()) return {};
  std::ranges::sort(together, {}, &RateCandidate::place);
  if (axes_differ(together)) return {together};
  std::vector<Rates> choices;
  for (const auto& [stem, columns] : sensors) {
    if (columns.size() != most) continue;
    if (axes_differ(columns))
      choices.push_back(columns);
    else
      for (const RateCandidate& column : columns) choices.push_back({column});
  }
  std::ranges::sort(choices, {}, [](const Rates& choice) { return choice[0].place; });
  if (choices.size() == 3 && together.size() == 3 && differ_in_a_word(table, together)) {
    name_axes(together);
    choices.insert(choices.begin(), together);
  }
  return choices;
}

// Mean change from row to row.
double scatter(const TableColumn& column) {
  double sum = 1e-300;  // of constant columns, which are all alike
  for (std::size_t i = 1; i < column.values.size(); ++i)
    sum += std::abs(column.values[i] - column.values[i - 1]);
  return sum;
}

// Without names: a single column of numbers, or three adjacent ones as axes. Prefers groups of three without
// gravity and with similar values (a heading differs from a rate).
std::vector<Rates> sensors_by_place(const TableSample& table, const std::optional<CsvTime>& time) {
  Rates found;
  const std::string counted = table.counting();
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const TableColumn& column = table.columns[i];
    const bool of_time =
        time && ("+" + time->header + "+").find("+" + column.name + "+") != std::string::npos;
    // A position or a pressure changes by less than a millionth from row to row.
    const bool changes = column.varies() && scatter(column) > 1e-6 * std::abs(column.values[0]) *
                                                                  static_cast<double>(column.values.size());
    if (!of_time && changes && column.name != counted) found.push_back({i});
  }
  if (found.empty()) return {};
  if (found.size() < 3) return {{found[0]}};
  std::vector<Rates> sensors;
  const std::size_t step = found.size() % 3 == 0 ? 3 : 1;
  for (std::size_t first = 0; first + 3 <= found.size(); first += step)
    name_axes(sensors.emplace_back(found.begin() + static_cast<std::ptrdiff_t>(first),
                                   found.begin() + static_cast<std::ptrdiff_t>(first) + 3));
  const auto prefer = [&sensors](auto&& is_likely) {
    if (std::ranges::any_of(sensors, is_likely))
      std::erase_if(sensors, [&](const Rates& axes) { return !is_likely(axes); });
  };
  prefer([](const Rates& axes) { return axes[2].place == axes[0].place + 2; });
  prefer([&](const Rates& axes) {
    return !is_gravity(table, axes) &&
           std::ranges::none_of(axes, [&](const auto& axis) { return is_gravity(table, {axis}); });
  });
  prefer([&](const Rates& axes) {
    const auto smooth =
        std::ranges::count_if(axes, [&](const auto& axis) { return table.columns[axis.place].is_smooth(); });
    return smooth == 0 || smooth == 3;
  });
  // Of overlapping ones the one whose columns scatter most alike.
  std::ranges::stable_sort(sensors, {}, [&](const Rates& axes) {
    const auto [least, most] =
        std::minmax({scatter(table.columns[axes[0].place]), scatter(table.columns[axes[1].place]),
                     scatter(table.columns[axes[2].place])});
    return most / least;
  });
  std::vector<Rates> apart;
  for (const Rates& axes : sensors)
    if (std::ranges::none_of(apart, [&](const Rates& other) {
          return axes[0].place <= other[2].place && other[0].place <= axes[2].place;
        }))
      apart.push_back(axes);
  std::ranges::sort(apart, {}, [](const Rates& axes) { return axes[0].place; });
  return apart;
}

// A rate in motion is as smooth as an angle, so only a lone column without a name is offered as an angle first.
std::vector<std::string> units_by_values(const TableSample& table, const Rates& rates) {
  std::vector<std::string> units{"rad/s", "deg/s", "deg/h", "rad/sample", "deg/sample"};
  if (rates.front().increment)
    std::rotate(units.begin(), units.begin() + 3, units.end());
  else if (std::ranges::any_of(rates,
                               [&](const auto& rate) { return table.columns[rate.place].is_smooth(); }))
    units.insert(!table.named && rates.size() == 1 ? units.begin() : units.end(), {"rad", "deg"});
  for (const RateCandidate& rate : rates)
    keep_measurable(units, table.columns[rate.place].values, [](const std::string& unit) {
      return measurable_in_file(CsvColumn{"rate_radps", "", unit});
    });
  return units;
}

}  // namespace

std::vector<Rates> sensors_of(const TableSample& table, const std::optional<CsvTime>& time, bool references) {
  return table.named ? sensors_by_name(table, references) : sensors_by_place(table, time);
}

void settle_units(const TableSample& table, Rates& rates) {
  const auto is_open = [](const RateCandidate& rate) { return rate.units.size() != 1; };
  const bool counts = std::ranges::all_of(
      rates, [&](const RateCandidate& rate) { return table.columns[rate.place].are_counts(); });
  // gcsv of Gyroflow; Epson's logger: "Gyro_SF=0.0151515".
  for (const auto& [name, unit] : {std::pair{"gscale", "rad/s"}, {"gyrosf", "deg/s"}})
    if (const auto scale = counts ? stated(table.comments, {name}) : std::nullopt)
      for (RateCandidate& rate : rates)
        if (is_open(rate)) rate.units = {unit}, rate.scale = *scale;
  if (std::ranges::none_of(rates, is_open)) return;
  const std::vector<std::string> units =
      rates.front().units.empty() ? units_by_values(table, rates) : rates.front().units;
  for (RateCandidate& rate : rates)
    if (is_open(rate)) rate.units = units;
}

}  // namespace ifog

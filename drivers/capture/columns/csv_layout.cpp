// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/columns/csv_layout.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>

#include "drivers/capture/columns/column.h"
#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

constexpr std::string_view kRateUnit = "radps";
constexpr std::string_view kPerSample = "/sample";

// A single letter is a unit only after its quantity.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kOneLetter = {
    {{"KCF", "temp"}, {"KCF", "_t_"}, {"VA", "supply"}, {"V", "volt"}, {"A", "current"}, {"g", "acc"}}};

[[noreturn]] void refuse(const std::string& text, const std::string& expected) {
  throw std::runtime_error(in_quotes(text) + ", expected " + expected);
}

std::string unit_of_name(const std::string& name) {
  const std::size_t underscore = name.rfind('_');
  return underscore == std::string::npos ? "" : name.substr(underscore + 1);
}

// "HEADER:UNIT" or "HEADER". A header may contain colons if a unit follows.
std::pair<std::string, std::string> header_and_unit(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

// Seconds in "ms" or "100us".
std::optional<double> seconds_in(const std::string& unit) {
  double factor = 1.0;
  const auto [end, error] = std::from_chars(unit.data(), unit.data() + unit.size(), factor);
  if (error == std::errc::invalid_argument) return time_unit(unit);
  const auto of = time_unit({end, static_cast<std::size_t>(unit.data() + unit.size() - end)});
  if (error != std::errc() || !of || !(factor > 0.0) || !std::isfinite(factor)) return std::nullopt;
  return factor * *of;
}

}  // namespace

CsvColumn CsvColumn::parse(const std::string& text) {
  const std::string form = "NAME=HEADER:UNIT, rate_x_radps=GyroX:deg/s";
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) refuse(text, form);
  CsvColumn out;
  out.name = text.substr(0, equals);
  std::tie(out.header, out.unit) = header_and_unit(text.substr(equals + 1));
  const auto [end, error] = std::from_chars(out.unit.data(), out.unit.data() + out.unit.size(), out.scale);
  if (error == std::errc() && out.scale != 0.0 && std::isfinite(out.scale))
    out.unit.erase(0, static_cast<std::size_t>(end - out.unit.data()));
  else
    out.scale = 1.0;
  const std::string wanted = unit_of_name(out.name);
  if (out.name == "time_s") refuse(text, "another name; --time says which column is the time");
  if (wanted.empty() || out.header.empty()) refuse(text, form);
  if (wanted == kRateUnit && !out.is_rate() && Words(out.name).have(Role::truth))
    refuse(text, "the name reference_rate_radps, or reference_rate_x_radps of an axis, for a true rate");
  std::string as_in_names = out.unit;  // m/s
  std::ranges::replace(as_in_names, '/', 'p');
  if (out.unit.empty() || out.angle_rad() || convert_unit(out.unit, wanted) || as_in_names == wanted)
    return out;
  const std::string known = other_units(wanted);
  refuse(
      text,
      known.empty()
          ? "the unit " + wanted + ", which is known by its name only"
          : "a unit that becomes " + wanted + ": " + known +
                (out.is_rate() ? ", or deg, rad of an angle, deg/sample, rad/sample of its increments" : ""));
}

std::string CsvColumn::own_unit() const { return unit_of_name(name); }

bool CsvColumn::is_rate() const {
  return own_unit() == kRateUnit &&
         (name.starts_with("rate_") || name.starts_with("reference_rate_") || is_other_rate(name));
}

std::optional<double> CsvColumn::angle_rad() const {
  if (!is_rate() || angle_unit(unit, true, false)) return std::nullopt;
  return angle_unit(unit.substr(0, unit.size() - (unit.ends_with(kPerSample) ? kPerSample.size() : 0)), false,
                    false);
}

UnitConversion CsvColumn::conversion() const {
  UnitConversion by;
  if (const auto rad = angle_rad())
    by = {*rad};
  else if (!unit.empty())
    by = convert_unit(unit, unit_of_name(name)).value_or(UnitConversion{});
  by.scale *= scale;
  return by;
}

std::string without_index(const std::string& name) {
  const std::size_t open = std::min(name.rfind('['), name.size());
  const std::size_t close = name.find_first_not_of("0123456789", open + 1);
  return close + 1 == name.size() && close > open + 1 && name.back() == ']' ? name.substr(0, open) : name;
}

std::string unit_in_name(const std::string& name) {
  const std::string header = without_index(name);
  for (const auto& [open, close] : {std::pair{'(', ')'}, {'[', ']'}}) {
    const std::size_t at = header.find(open);
    if (at == std::string::npos || header.back() != close) continue;
    const std::string inside = header.substr(at + 1, header.size() - at - 2);
    const std::string unit = inside.starts_with("in ") ? inside.substr(3) : inside;
    return is_unit(unit) ? unit : "";
  }
  // UncalGyroXRadPerSec, rate_x_degrees_per_second
  if (const std::size_t per = lower(header).rfind("per"); per != std::string::npos && per > 3) {
    const std::size_t begin = header.find_last_of(" _ABCDEFGHIJKLMNOPQRSTUVWXYZ", per - 2) + 1;
    for (std::string rate : {header.substr(begin), header.substr(begin - (begin > 0 ? 1 : 0))})
      if (angle_unit(rate, true, false)) return rate;
  }
  // "Gyro X, deg/s", "Gyro X in deg/s"; "min" is usually a minimum.
  std::string behind = header.substr(header.find_last_of(" ,:") + 1);
  if (behind == "s" || (behind.size() > 1 && is_unit(behind) && !says(behind, Role::no_rate))) return behind;
  const std::string last = unit_of_name(header);
  // omega_z_deg_h: a quotient without a slash.
  if (const std::size_t line = header.rfind('_'); line != std::string::npos && line > 0 && !last.empty()) {
    const std::string angle = unit_of_name(header.substr(0, line));
    if (angle_unit(angle, false, false) && time_unit(last)) return angle + "/" + last;
  }
  if (last == "s" || last == "S") return "s";
  if (last.size() == 1)
    return std::ranges::any_of(kOneLetter,
                               [&](const auto& each) {
                                 return each.first.find(last) != std::string_view::npos &&
                                        ("_" + lower(header)).find(each.second) != std::string::npos;
                               })
               ? last
               : "";
  return angle_unit(last, true, false) || time_unit(last) || !other_units(last).empty() ? last : "";
}

CsvTime CsvTime::parse(const std::string& text) {
  CsvTime out;
  std::tie(out.header, out.unit) = header_and_unit(text);
  const bool order = out.unit == kDayFirst || out.unit == kMonthFirst;
  if (out.header.empty() || (!out.unit.empty() && !order && !seconds_in(out.unit)))
    refuse(text, "HEADER:UNIT with a unit of time: s, ms, us, 100us, ns, min, h, d; d/m/y or m/d/y of dates");
  return out;
}

double CsvTime::unit_s() const { return seconds_in(unit).value_or(1.0); }

char CsvLayout::parse_separator(const std::string& text) {
  if (text == "tab" || text == "\\t") return '\t';
  constexpr std::string_view kNever = "+-.\"'#_\n\r";
  if (text.size() != 1 || std::isalnum(static_cast<unsigned char>(text[0])) != 0 ||
      kNever.find(text[0]) != std::string_view::npos)
    refuse(text, "one character that stands between cells, ';', or the word tab");
  return text[0];
}

void CsvLayout::parse_only(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    refuse(text, "HEADER=VALUE, sensor_id=0");
  only_header = text.substr(0, equals);
  only_value = text.substr(equals + 1);
  if (only_value == "*") only_value.clear();
}

bool is_number_of_column(const std::string& header) {
  return header.size() > 1 && header[0] == '#' &&
         header.find_first_not_of("0123456789", 1) == std::string::npos;
}

std::vector<std::string> parts_of_time(const std::string& header,
                                       const std::function<bool(const std::string&)>& is_column) {
  if (is_column(header)) return {header};
  for (std::size_t plus = header.find('+'); plus != std::string::npos; plus = header.find('+', plus + 1))
    if (is_column(header.substr(0, plus)) && is_column(header.substr(plus + 1)))
      return {header.substr(0, plus), header.substr(plus + 1)};
  return {header};
}

std::string option_for(const CsvColumn& column, const std::string& unit) {
  const std::string scale = column.scale == 1.0 ? "" : shortest(column.scale);
  return "--column " +
         shell_word(column.name + "=" + column.header + (unit.empty() ? "" : ":" + scale + unit));
}

std::string option_for(const CsvTime& time) {
  return "--time " + shell_word(time.header + (time.unit.empty() ? "" : ":" + time.unit));
}

bool is_unit(const std::string& text) {
  return angle_unit(text, true, false) || angle_unit(text, false, false) || time_unit(text) ||
         !other_units(text).empty();
}

std::string without_brackets(const std::string& unit) {
  for (const auto& [open, close] : {std::pair{'(', ')'}, {'[', ']'}})
    if (unit.size() >= 2 && unit.front() == open && unit.back() == close)
      return unit.substr(1, unit.size() - 2);
  return unit;
}

std::optional<std::string> name_with_unit(const std::string& header, const std::string& unit) {
  if (unit.empty()) return header;
  std::string own = unit_in_name(header);
  if (own.empty() && (convert_unit(unit_of_name(header), unit) || unit_of_name(header) == unit))
    own = unit_of_name(header);
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  if (own.empty())
    return std::ranges::all_of(unit, is_word) ? header + "_" + unit : header + " [" + unit + "]";
  const auto by = convert_unit(unit, own);
  if (unit == own || (by && by->scale == 1.0 && by->offset == 0.0)) return header;
  return std::nullopt;
}

}  // namespace ifog

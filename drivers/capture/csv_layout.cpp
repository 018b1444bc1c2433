// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv_layout.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>

#include "drivers/capture/measurable.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

constexpr std::string_view kRateUnit = "radps";
constexpr std::string_view kPerSample = "/sample";

[[noreturn]] void refuse(const std::string& text, const std::string& expected) {
  throw std::runtime_error(in_quotes(text) + ", expected " + expected);
}

std::string unit_of_name(const std::string& name) {
  const std::size_t underscore = name.rfind('_');
  return underscore == std::string::npos ? "" : name.substr(underscore + 1);
}

bool names_a_rate(const std::string& name) {
  return unit_of_name(name) == kRateUnit &&
         (name.starts_with("rate_") || name.starts_with("reference_rate_"));
}

// "HEADER:UNIT" or "HEADER". A header may hold colons itself where a unit follows.
std::pair<std::string, std::string> header_and_unit(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// A header taken apart: "GyroX (deg/s)" is "gyrox" and "deg/s", "gyro_x_dps" is "gyro_x" and "dps".
struct Parts {
  std::string base, unit;
};

Parts parts_of(const std::string& header) {
  for (const auto& [open, close] : {std::pair{'(', ')'}, {'[', ']'}}) {
    const std::size_t at = header.find(open);
    if (at == std::string::npos || header.back() != close) continue;
    std::string base = header.substr(0, at);
    while (!base.empty() && (base.back() == ' ' || base.back() == '_')) base.pop_back();
    return {lower(base), header.substr(at + 1, header.size() - at - 2)};
  }
  const std::size_t underscore = header.rfind('_');
  if (underscore == std::string::npos) return {lower(header), ""};
  const std::string last = header.substr(underscore + 1);
  const bool unit = angle_unit(last, true, false) || time_unit(last) || !units_beside(last).empty();
  // A lone letter is an axis rather than coulombs.
  const std::string base = lower(header.substr(0, underscore));
  if (last == "s" || last == "S") return {base, "s"};
  if (!unit || (last.size() == 1 && stated_unit(base + "_" + last).empty())) return {lower(header), ""};
  return {base, last};
}

// The axis that a rate's header ends in, if its beginning speaks of a rate; `raw` is what `ifog denoise`
// calls what was measured.
std::optional<std::string> rate_axis(const std::string& base) {
  if (base == "raw") return "";
  if (base.size() == 5 && base.starts_with("raw_")) return base.substr(4);
  constexpr std::array<std::string_view, 9> kWords{"gyroscope",       "gyro",   "gyr", "rate", "omega",
                                                   "angularvelocity", "angvel", "w",   "g"};
  std::string squeezed;
  for (const char c : base)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) squeezed += c;
  for (const std::string_view word : kWords) {
    const std::size_t at = squeezed.find(word);
    // The short ones are whole names: gx, wz.
    if (at == std::string::npos || (word.size() == 1 && (at != 0 || squeezed.size() != 2))) continue;
    if (word == "rate" && at != 0) continue;  // frame_rate
    const std::string rest = squeezed.substr(at + word.size());
    if (rest.empty()) return "";
    for (const char axis : {'x', 'y', 'z'})
      if (rest.front() == axis || rest.back() == axis) return std::string(1, axis);
    if (word.size() > 1) return "";
  }
  return std::nullopt;
}

bool is_time(const std::string& base) {
  constexpr std::array<std::string_view, 17> kNames{
      "t",        "time",     "timestamp", "time_stamp",    "utc",    "utc_time",
      "time_utc", "datetime", "date_time", "timestamp_utc", "date",   "iso_time",
      "zeit",     "seconds",  "elapsed",   "tow",           "gps_tow"};
  return std::find(kNames.begin(), kNames.end(), base) != kNames.end();
}

// What another column than the sensor's rate would be called in a capture, by the first unit of its quantity:
// temperature_degC for degF. "" where its unit says nothing, or it is a rate that is no reference: made of
// the sensor's own, it would explain that away.
std::string channel_name(const Parts& parts) {
  const bool rate = angle_unit(parts.unit, true, false).has_value();
  const std::string known = rate ? std::string(kRateUnit) : units_beside(parts.unit);
  std::string name;
  for (const char c : parts.base) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  if (known.empty() || name.empty() || time_unit(parts.unit)) return "";
  if (rate && !name.starts_with("reference_rate")) return "";
  return name + "_" + known.substr(0, known.find(','));
}

bool is_another(const std::string& unit, const std::string& wanted) {
  const auto by = convert_unit(unit, wanted);
  return by && (by->scale != 1.0 || by->offset != 0.0);
}

}  // namespace

CsvColumn CsvColumn::parse(const std::string& text) {
  const std::string form = "NAME=HEADER:UNIT, rate_x_radps=GyroX:deg/s";
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) refuse(text, form);
  CsvColumn out;
  out.name = text.substr(0, equals);
  std::tie(out.header, out.unit) = header_and_unit(text.substr(equals + 1));
  const std::string wanted = unit_of_name(out.name);
  if (out.name == "time_s") refuse(text, "another name; --time says which column is the time");
  if (wanted.empty() || out.header.empty()) refuse(text, form);
  if (out.unit.empty() || out.angle_rad() || convert_unit(out.unit, wanted)) return out;
  const std::string known = units_beside(wanted);
  refuse(
      text,
      known.empty()
          ? "the unit " + wanted + ", which is known by its name only"
          : "a unit that becomes " + wanted + ": " + known +
                (out.is_rate() ? ", or deg, rad of an angle, deg/sample, rad/sample of its increments" : ""));
}

bool CsvColumn::is_rate() const { return names_a_rate(name); }

bool CsvColumn::is_angle() const {
  return is_rate() && !angle_unit(unit, true, false) && angle_unit(unit, false, false).has_value();
}

bool CsvColumn::is_increment() const {
  return is_rate() && unit.ends_with(kPerSample) && angle_rad().has_value();
}

std::optional<double> CsvColumn::angle_rad() const {
  if (is_angle()) return angle_unit(unit, false, false);
  if (!is_rate() || !unit.ends_with(kPerSample)) return std::nullopt;
  return angle_unit(unit.substr(0, unit.size() - kPerSample.size()), false, false);
}

std::string CsvColumn::other_unit() const {
  if (!unit.empty()) return "";
  std::string stated = parts_of(header).unit;
  // A rate that ends in an angle's unit is often one a second: here it is no guess but a question. "rads" is
  // both.
  if (stated.empty() && is_rate() && unit_of_name(header) != "rads") stated = unit_of_name(header);
  if (stated.empty()) return "";
  CsvColumn told = *this;
  told.unit = stated;
  return told.angle_rad() || is_another(stated, unit_of_name(name)) ? stated : "";
}

std::string CsvTime::other_unit() const {
  if (told || unit_s != 1.0) return "";
  const std::string stated = parts_of(header).unit;
  return time_unit(stated).value_or(1.0) != 1.0 ? stated : "";
}

CsvTime CsvTime::parse(const std::string& text) {
  const auto [header, unit] = header_and_unit(text);
  CsvTime out;
  out.header = header;
  const auto seconds = unit.empty() ? std::optional(1.0) : time_unit(unit);
  if (header.empty() || !seconds) refuse(text, "HEADER:UNIT with a unit of time: s, ms, us, ns, min, h");
  out.unit_s = *seconds;
  out.told = !unit.empty();
  return out;
}

char CsvLayout::parse_separator(const std::string& text) {
  if (text == "tab" || text == "\\t") return '\t';
  constexpr std::string_view kNever = "+-.\"'#_\n\r";
  if (text.size() != 1 || std::isalnum(static_cast<unsigned char>(text[0])) != 0 ||
      kNever.find(text[0]) != std::string_view::npos)
    refuse(text, "one character that stands between cells, ';', or the word tab");
  return text[0];
}

std::string option_for(const CsvColumn& column, const std::string& unit) {
  CsvColumn told = column;
  told.unit = unit;
  return "--column " + shell_word(column.name + "=" + column.header + ":" + unit) +
         (told.is_angle()
              ? " (or " + unit + std::string(kPerSample) + ", of what was turned since the row before)"
              : "");
}

std::string option_for(const CsvTime& time, const std::string& unit) {
  return "--time " + shell_word(time.header + ":" + unit);
}

std::string suggested_options(const std::vector<std::string>& headers, bool dated) {
  std::string time, columns;
  bool timed = false, renamed = false;
  std::vector<std::string> taken, named;
  for (const std::string& header : headers) {
    if (header.empty()) continue;
    const Parts parts = parts_of(header);
    if (!timed && is_time(parts.base)) {
      timed = true;
      const std::string unit = dated ? "s" : time_unit(parts.unit) ? parts.unit : "UNIT";
      if (header != "time_s") time = " " + option_for(CsvTime{header}, unit);
      continue;
    }
    const auto axis = rate_axis(parts.base);
    const bool fits = parts.unit.empty() || angle_unit(parts.unit, true, false);
    const bool rate = axis && fits && std::find(taken.begin(), taken.end(), *axis) == taken.end();
    std::string name = channel_name(parts);
    if (rate) {
      taken.push_back(*axis);
      name = axis->empty() ? "rate_radps" : "rate_" + *axis + "_radps";
    }
    if (name.empty() || std::find(named.begin(), named.end(), name) != named.end()) continue;
    named.push_back(name);
    renamed = renamed || (rate && name != header);
    columns += " " + option_for({name, header, ""}, parts.unit.empty() ? "UNIT" : parts.unit);
  }
  // Half of it would only lead to the next message.
  if (!timed || taken.empty()) return "";
  const std::string all = time + (renamed ? columns : "");
  return all.empty() ? "" : all.substr(1);
}

bool is_unit(const std::string& text) {
  return angle_unit(text, true, false) || angle_unit(text, false, false) || time_unit(text) ||
         !units_beside(text).empty();
}

std::optional<std::string> name_with_unit(const std::string& header, const std::string& unit) {
  std::string bare = unit;
  for (const auto& [open, close] : {std::pair{'(', ')'}, {'[', ']'}})
    if (bare.size() >= 2 && bare.front() == open && bare.back() == close)
      bare = bare.substr(1, bare.size() - 2);
  if (bare.empty() || bare == "-" || bare == "1") return header;
  std::string own = parts_of(header).unit;
  if (own.empty() && (convert_unit(unit_of_name(header), bare) || unit_of_name(header) == bare))
    own = unit_of_name(header);
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  if (own.empty())
    return std::all_of(bare.begin(), bare.end(), is_word) ? header + "_" + bare : header + " [" + bare + "]";
  const auto by = convert_unit(bare, own);
  if (bare == own || (by && by->scale == 1.0 && by->offset == 0.0)) return header;
  return std::nullopt;
}

std::string suggested_separator(const std::string& header_line) {
  if (header_line.find(',') != std::string::npos) return "";
  for (const auto& [separator, text] : {std::pair{';', "';'"}, {'\t', "tab"}, {'|', "'|'"}})
    if (header_line.find(separator) != std::string::npos) return std::string("--separator ") + text;
  return "";
}

}  // namespace ifog

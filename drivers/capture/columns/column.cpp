// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/columns/column.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/times/date_time.h"
#include "drivers/ifog/quoted.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

// Words of each role, separated by blanks. speed: a rate if with a turning word. glued: may be joined with an
// axis (xgyro, wx). step: before an angle, the turn within a sample. no_time: belongs to a time, but not that
// of the rows. one: numbers or names one of several sensors.
constexpr std::array<std::pair<Role, std::string_view>, 11> kWords{{
    {Role::rate,
     " gyro gyr gyros gyroscope gyroskop drehrate omega angvel angrate angularvelocity angularrate "
     "rotationrate "
     "turnrate turnspeed fog "},
    {Role::speed, " rate speed velocity vel "},
    {Role::turn, " angular ang rotation rot turn body "},
    {Role::glued,
     " gyro gyr gyroscope omega rate angvel angrate w g angularvelocity angularrate rotationrate dtheta "
     "dangle "},
    // Quantities derived from a rate, its descriptions, or other quantities are no rates.
    {Role::no_rate,
     " bias offset range std stddev sigma var variance cov covariance noise temp temperature id dt status "
     "state count counter num flag flags valid clip clipping quality scale sf min max mean avg rms err "
     "error residual limit threshold gain timestamp tmp sts period relative sample sampling update frame "
     "odr integral accel acc acceleration accelerometer mag magnetometer denoised compensated innovation "
     "command commanded cmd setpoint desired target drift "},
    {Role::truth,
     " reference ref truth true groundtruth gt table turntable ratetable encoder "
     "command commanded "},
    {Role::step, " delta inc increment "},
    {Role::angle, " angle theta ang heading winkel integrated cumulative "},
    {Role::time,
     " time timestamp stamp tick ticks t utc datetime date zeit zeitstempel seconds elapsed tow sow "
     "sampletimefine "
     "timeusec secs "
     "millis micros nanos milliseconds microseconds nanoseconds gpst gpstow epoch tiempo temps "},
    {Role::no_time,
     " dt relative period delta integral id status valid offset zone delay age exposure week accuracy "
     "interval flags tflags hour minute year month nano "},
    {Role::one, " id sensor device instance topic i imu "},
}};

bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

std::string without_unit(const std::string& header) {
  const std::size_t bracket = header.find_last_of("([");  // "Gyroscope (z) [rad/s]" has an axis before it
  if (bracket != std::string::npos && bracket > 0 && (header.back() == ')' || header.back() == ']'))
    return header.substr(0, bracket);
  const std::size_t unit = unit_in_name(header).size();
  return header.size() > unit ? header.substr(0, header.size() - unit) : header;
}

// Splits at non-letters, at a digit after a letter, and at capitals that start a word.
std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  const auto end_word = [&] {
    if (!word.empty()) words.push_back(lower(word));
    word.clear();
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i], before = i > 0 ? text[i - 1] : ' ',
               behind = i + 1 < text.size() ? text[i + 1] : ' ';
    if (!is_letter(c) && !is_digit(c)) {
      end_word();
      continue;
    }
    const bool begins = is_letter(c) && is_letter(before) && is_upper(c) &&
                        (!is_upper(before) || (is_letter(behind) && !is_upper(behind)));
    if (begins || is_digit(c) != is_digit(before)) end_word();
    word += c;
  }
  end_word();
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    // DelAX of ArduPilot: a delta angle.
    if (words[i] == "del" && words[i + 1].size() == 2 && words[i + 1][0] == 'a') {
      words.push_back(words[i + 1].substr(1));
      words[i] = "delta", words[i + 1] = "angle";
    }
    // dTheta, dAngle: one word.
    if (words[i] == "d" && (words[i + 1] == "theta" || words[i + 1] == "angle" || words[i + 1] == "ang")) {
      words[i] += words[i + 1];
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
  }
  return words;
}

// Axis joined with a rate word: xgyro, gyrox, wx.
std::optional<std::string> glued_axis(std::string& word) {
  if (word.size() < 2) return std::nullopt;
  const auto is_axis = [](char c) { return c >= 'x' && c <= 'z'; };
  std::string rest = word.substr(0, word.size() - 1), axis = word.substr(word.size() - 1);
  if (!is_axis(axis[0]) || !says(rest, Role::glued)) {
    axis = word.substr(0, 1), rest = word.substr(1);
    if (!is_axis(axis[0]) || !says(rest, Role::glued)) return std::nullopt;
  }
  word = rest;
  return axis;
}

// Roll axis of an aircraft or vehicle is x. Removes it from the word: "rollrate" becomes "rate".
std::string axis_of_turn(std::string& word) {
  constexpr std::array<std::pair<std::string_view, const char*>, 3> kTurns{
      {{"roll", "x"}, {"pitch", "y"}, {"yaw", "z"}}};
  for (const auto& [name, axis] : kTurns) {
    if (!word.starts_with(name)) continue;
    word.replace(0, name.size(), "turn");
    return axis;
  }
  return "";
}

// Unit in ASCII: deg/s for a degree sign of another encoding than UTF-8.
std::string typed(const std::string& unit) {
  if (is_utf8(unit)) return unit;
  for (const char* const known : {"deg/s", "rad/s", "deg", "deg/h", "degC", "s", "us"}) {
    const auto by = convert_unit(unit, known);
    const auto angle = angle_unit(unit, false, false);
    if ((by && by->scale == 1.0 && by->offset == 0.0) || (angle && angle == angle_unit(known, false, false)))
      return known;
  }
  return unit;
}

std::string unit_by_name(const std::string& name, const std::string& text) {
  const std::string unit = unit_in_name(name);
  // A magnetometer's G is gauss, not gravity.
  if (text.starts_with("mag") && (unit == "G" || unit == "mG")) return unit == "G" ? "gauss" : "mgauss";
  if (!unit.empty()) return typed(unit);
  const std::string last = text.substr(text.rfind('_') + 1);  // gyro_rad[0]
  return angle_unit(last, false, false) ? last : "";
}

}  // namespace

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_utf8(const std::string& text) { return printable(text, text.size()) == text; }

std::string in_utf8(const std::string& text) {
  if (is_utf8(text)) return text;
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80U) out += static_cast<char>(0xC0U | byte >> 6U);
    out += static_cast<char>(byte >= 0x80U ? 0x80U | (byte & 0x3FU) : byte);
  }
  return out;
}

bool says(std::string_view word, Role role) {
  const auto* const words =
      std::ranges::find_if(kWords, [role](const auto& each) { return each.first == role; });
  return words->second.find(" " + std::string(word) + " ") != std::string_view::npos;
}

Words::Words(const std::string& header) {
  const std::string unnumbered = without_index(header), bare = without_unit(unnumbered);
  if (unnumbered.size() + 3 == header.size()) number = header[unnumbered.size() + 1];
  const bool any_language = is_utf8(bare);
  for (const char c : lower(bare)) {
    const bool foreign = any_language && static_cast<unsigned char>(c) >= 0x80U;
    text += is_letter(c) || is_digit(c) || foreign ? c : '_';
  }
  while (!text.empty() && text.back() == '_') text.pop_back();
  std::string turned;
  for (std::string& word : split(bare)) {
    const bool axis_alone = word == "x" || word == "y" || word == "z";
    if (axis_alone && axis.empty()) {
      axis = word;
      continue;
    }
    if (axis.empty())
      if (const auto glued = glued_axis(word)) axis = *glued;
    if (const std::string turn = axis_of_turn(word); !turn.empty()) turned = turn;
    words.push_back(word);
    stem += (stem.empty() ? "" : " ") + word;
  }
  if (axis.empty()) axis = turned;
  // gyro_0, gyro_1, gyro_2
  if (axis.empty() && number == '\0' && words.size() > 1 && words.back().size() == 1 &&
      is_digit(words.back()[0])) {
    number = words.back()[0];
    words.pop_back();
    stem = stem.substr(0, stem.rfind(' '));
  }
}

bool Words::has(std::string_view word) const { return std::ranges::find(words, word) != words.end(); }

bool Words::have(Role role) const {
  return std::ranges::any_of(words, [role](const std::string& word) { return says(word, role); });
}

TableColumn::TableColumn(std::string column, const std::string& said, std::vector<std::string> first_cells)
    : name(std::move(column)), stated(typed(said)), unit(stated), words(name) {
  if (unit.empty()) unit = unit_by_name(name, words.text);
  set_cells(std::move(first_cells));
}

void TableColumn::set_cells(std::vector<std::string> first_cells) {
  cells = std::move(first_cells);
  filled.clear();
  values.clear();
  for (const std::string& cell : cells) {
    if (cell.empty()) continue;
    filled.push_back(cell);
    if (const auto value = finite_number(cell)) values.push_back(*value);
  }
}

bool TableColumn::is_dates() const {
  return !filled.empty() && std::ranges::all_of(filled, [](const auto& cell) { return is_date(cell); });
}

bool TableColumn::varies() const {
  return !values.empty() &&
         (values.size() < 2 || std::ranges::any_of(values, [&](double v) { return v != values[0]; }));
}

bool TableColumn::is_whole() const {
  return std::ranges::all_of(values, [](double v) { return v == std::floor(v); });
}

bool TableColumn::counts_rows() const {
  std::size_t other = 0;
  for (std::size_t i = 1; i < values.size(); ++i) other += values[i] - values[i - 1] != 1.0 ? 1 : 0;
  return values.size() >= kFewRows && other <= 1 && is_whole();
}

bool TableColumn::increases() const {
  return values.size() >= kFewRows && is_numeric() &&
         std::ranges::adjacent_find(values, std::greater_equal<>()) == values.end();
}

bool TableColumn::is_smooth() const {
  constexpr double kSmooth = 0.5;
  if (values.size() < kFewRows) return false;
  double mean = 0.0, around = 0.0, differences = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    around += std::pow(values[i] - mean, 2.0);
    if (i > 0) differences += std::pow(values[i] - values[i - 1], 2.0);
  }
  return differences < kSmooth * around;
}

void TableSample::set(const std::vector<std::string>& names, const std::vector<std::string>& units,
                      const std::vector<std::vector<std::string>>& cells) {
  columns.clear();
  std::map<std::string, std::set<char>> numbers;  // of names that are equal otherwise
  for (std::size_t i = 0; i < names.size(); ++i) {
    TableColumn& column = columns.emplace_back(names[i], units.empty() ? "" : units[i], cells[i]);
    const bool alone = !names[i].empty() && std::ranges::count(names, names[i]) == 1;
    column.header = alone && is_utf8(names[i]) ? names[i] : "#" + std::to_string(i + 1);
    if (column.words.number != '\0') numbers[column.words.stem].insert(column.words.number);
  }
  // Numbers count the axes from 0 or 1, unless there are more than three.
  for (TableColumn& column : columns) {
    Words& words = column.words;
    if (words.number == '\0' || !words.axis.empty()) continue;
    const std::set<char>& all = numbers[words.stem];
    const char first = *all.begin() == '0' ? '0' : '1';
    if (*all.rbegin() - first <= 2) words.axis = axis_name(static_cast<std::size_t>(words.number - first));
  }
}

void TableSample::keep_rows(std::size_t place, const std::string& cell) {
  const std::vector<std::string> which = columns[place].cells;
  for (TableColumn& column : columns) {
    std::size_t row = 0;
    std::erase_if(column.cells, [&](const std::string&) { return which[row++] != cell; });
    column.set_cells(std::move(column.cells));
  }
}

std::vector<std::string> TableSample::names() const {
  std::vector<std::string> out;
  for (const TableColumn& column : columns) out.push_back(column.name);
  return out;
}

std::string TableSample::counting() const {
  const auto found = std::ranges::find_if(columns, &TableColumn::counts_rows);
  return found == columns.end() ? "" : found->name;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/columns/column_roles.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/times/date_time.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

constexpr double kSlowest_hz = 1.0, kFastest_hz = 10'000.0;  // range of logged gyros' sample rates

// Number after one of these names in a line above the table.
std::optional<double> stated(const std::vector<std::string>& comments,
                             std::initializer_list<std::string_view> names) {
  constexpr std::size_t kBetween = 12;  // characters, such as ": "
  for (const std::string& comment : comments) {
    std::string text = lower(comment);
    std::erase_if(text, [](char c) { return c == ' ' || c == '_'; });
    for (const std::string_view name : names) {
      const std::size_t at = text.find(name);
      if (at == std::string::npos) continue;
      const std::size_t digits = text.find_first_of("0123456789", at + name.size());
      if (digits == std::string::npos || digits > at + name.size() + kBetween) break;
      const double value = std::strtod(text.c_str() + digits, nullptr);
      if (value > 0.0) return value;
      break;
    }
  }
  return std::nullopt;
}

// Without empty cells, i.e. rows of another sensor.
std::vector<std::string> filled(const std::vector<std::string>& cells) {
  std::vector<std::string> out;
  std::ranges::copy_if(cells, std::back_inserter(out), [](const std::string& cell) { return !cell.empty(); });
  return out;
}

// True if values increase at least once in `each` steps, and hardly ever decrease. A named time may decrease
// more often, because its rows are checked one by one.
bool goes_on(const std::vector<double>& values, std::size_t each, bool named) {
  std::size_t back = 0, on = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] < values[i - 1]) ++back;
    if (values[i] > values[i - 1]) ++on;
  }
  return values.size() < 2 ||
         (on > 0 && each * on >= values.size() - 1 && (back <= 1 || (named && 2 * back < on)));
}

bool counts(const std::vector<double>& values) {
  if (values.size() < kFewRows) return false;
  std::size_t other = 0;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i] - values[i - 1] != 1.0) ++other;
  return other <= 1 && std::ranges::all_of(values, [](double v) { return v == std::floor(v); });
}

// Unit in which the rows have the stated rate; "" if there is none.
std::string unit_by_stated_rate(const TableSample& table, double step) {
  constexpr double kNear = 0.1;  // relative; units differ by factors of ten
  const auto stated_hz = stated_rate_hz(table.comments);
  for (const char* unit : {"s", "ms", "100us", "us", "ns"})
    if (stated_hz && std::abs(step * CsvTime{"", unit}.unit_s() * *stated_hz - 1.0) < kNear) return unit;
  return "";
}

// Mean of the positive steps, because a rollover steps back and bursts have many short steps.
double mean_step(const std::vector<double>& values) {
  double forward = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) forward += std::max(0.0, values[i] - values[i - 1]);
  return forward / static_cast<double>(values.size() - 1);
}

// Sets the unit in which the values are times since 1970, or the only one with a plausible sample rate. The remark names
// another one in which the rows are as far apart as those of a slow log.
void guess_unit(CsvTime& time, const std::vector<double>& values) {
  if (values.size() < 2) return;
  const double step = mean_step(values);
  for (const char* unit : {"s", "ms", "us", "ns", "d"}) {
    const double unit_s = CsvTime{"", unit}.unit_s(), rate_hz = 1.0 / (step * unit_s);
    // From the year 2000 on; days are counted from other years.
    const double since = values.front() * unit_s / 9.4e8;
    if (unit_s <= 1.0 && since >= 1.0 && since < 5.0 && rate_hz > 1e-2 * kSlowest_hz &&
        rate_hz < 10.0 * kFastest_hz) {
      time.unit = unit;
      return;
    }
    if (!(rate_hz >= kSlowest_hz && rate_hz <= kFastest_hz)) continue;
    if (!time.unit.empty()) return time.unit.clear();
    time.unit = unit;
  }
  if (time.unit.empty()) return;
  std::ostringstream remark;
  remark.precision(4);
  remark << " (not named; gives " << 1.0 / (step * time.unit_s()) << " Hz";
  for (const char* unit : {"s", "ms", "min", "h", "d"}) {
    const double period_s = step * CsvTime{"", unit}.unit_s();
    const auto near = [=](double slow_s) { return std::abs(period_s - slow_s) < 1e-3 * slow_s; };
    if (unit == time.unit || std::ranges::none_of(std::array{1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0}, near))
      continue;
    remark << "; " << 1.0 / period_s << " Hz if it is in " << unit << ": "
           << option_for(CsvTime{time.header, unit});
    break;
  }
  time.remark = remark.str() + ")";
}

// Likelihood from its name that a column is the rows' time; 0: none.
int rank_of(const std::string& name, const Words& words) {
  if (name == "time_s") return 5;
  if (words.have(Role::no_time)) return 0;
  // UTC_Day, UTC_Second: parts of a date.
  if (words.first() == "utc" && (words.has("day") || words.has("second"))) return 0;
  const auto is_time = [](const std::string& word) {
    return word.ends_with("time") || word.ends_with("stamp") || says(word, Role::time);
  };
  if (words.has("header") && words.has("stamp")) return 4;  // measurement time in ROS
  if (!words.words.empty() && std::ranges::all_of(words.words, is_time)) return 3;
  return std::ranges::any_of(words.words, is_time) ? 2 : 0;
}

bool are_dates(const std::vector<std::string>& cells) {
  return !cells.empty() && std::ranges::all_of(cells, [](const auto& cell) { return is_date(cell); });
}

std::string time_unit_by_name(const TableSample& table, std::size_t place, const Words& words) {
  if (std::string named = table.unit_of(place); time_unit(named)) return named;
  const std::vector<double> values = numbers_in(table.cells[place]);
  if (std::string stated = unit_by_stated_rate(table, mean_step(values)); !stated.empty()) return stated;
  if (const auto scale = stated(table.comments, {"tscale"})) return shortest(*scale) + "s";  // gcsv
  // Xsens: a clock of 10 kHz; of a DOT, which sends 120 samples/s at most, of 1 MHz.
  if (words.has("sample") && words.has("time") && words.has("fine"))
    return mean_step(values) < 1e6 / 120.0 - 1.0 ? "100us" : "us";
  constexpr std::array<std::pair<const char*, Role>, 4> kUnits{
      {{"ms", Role::ms}, {"us", Role::us}, {"ns", Role::ns}, {"s", Role::s}}};
  for (const auto& [unit, role] : kUnits)
    if (words.have(role)) return unit;
  return "";
}

// True if both advance by the same time from first to last row, within a step of the coarser clock.
bool go_together(const std::vector<double>& a, const CsvTime& one, const std::vector<double>& b,
                 const CsvTime& other) {
  if (one.unit.empty() || other.unit.empty() || a.size() != b.size() || a.size() < kFewRows) return false;
  const double of_one = one.unit_s(), of_other = other.unit_s();
  const double s = (a.back() - a.front()) * of_one, t = (b.back() - b.front()) * of_other;
  double step = 0.1 * std::abs(s) / static_cast<double>(a.size());
  for (std::size_t i = 1; i < a.size(); ++i)
    step = std::max({step, (a[i] - a[i - 1]) * of_one, (b[i] - b[i - 1]) * of_other});
  return std::abs(s - t) <= step;
}

// Fraction after GPS week and second, which are constant in the first rows.
bool is_fraction_of_second(const TableSample& table, std::size_t place, const std::vector<double>& values) {
  constexpr double kSecondsPerWeek = 604'800.0;
  if (table.named || place < 2 || values.empty() || varies(table.cells[place - 1])) return false;
  const auto week = finite_number(table.cells[place - 2][0]),
             second = finite_number(table.cells[place - 1][0]);
  return week && second && *week > 0.0 && *week < 1e4 && *week == std::floor(*week) && *second > 1.0 &&
         *second < kSecondsPerWeek &&
         std::ranges::all_of(values, [](double v) { return v >= 0.0 && v < 1.0; });
}

std::optional<CsvTime> candidate_at(const TableSample& table, std::size_t place, const Words& words) {
  if (is_empty(table.cells[place])) return std::nullopt;
  const std::vector<std::string> cells = filled(table.cells[place]);
  const bool dated = are_dates(cells);
  // A date that is the same in all rows is no time; a time of day in whole seconds may be.
  if (dated && cells.size() > 1 && cells.front() == cells.back() && cells[0].find(':') == std::string::npos)
    return std::nullopt;
  const std::vector<double> values = numbers_in(cells);
  const std::string unit = table.unit_of(place);
  const bool other_quantity = !time_unit(unit) && !other_units(unit).empty();  // T (°C)
  // NMEA's 235959.5 is no number of seconds.
  const bool clock_digits = !dated && lower(table.names[place]).find("hhmmss") != std::string::npos;
  if (other_quantity || clock_digits || is_fraction_of_second(table, place, values)) return std::nullopt;
  CsvTime out{table.header_of(place), dated ? "s" : time_unit_by_name(table, place, words)};
  // Several rows may have one stamp; without a name a quantity that hardly changes is no time.
  const std::size_t each = table.named ? cells.size() : kFewRows;
  if (!dated && (values.size() != cells.size() || !goes_on(values, each, table.named) ||
                 (out.unit.empty() && counts(values))))
    return std::nullopt;
  if (out.unit.empty()) guess_unit(out, values);
  return out;
}

// Decimal digits of a word for a part of a second (nsec, nanoseconds, us, msecs); 0 for others.
int digits_of(std::string_view word) {
  for (const auto& [prefix, digits] :
       {std::pair{"nano", 9}, {"micro", 6}, {"milli", 3}, {"n", 9}, {"u", 6}, {"m", 3}}) {
    if (!word.starts_with(prefix)) continue;
    const std::string_view rest = word.substr(std::string_view(prefix).size());
    if (rest == "s" || rest == "sec" || rest == "secs" || rest == "second" || rest == "seconds")
      return digits;
  }
  return 0;
}

std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  for (const char c : lower(name))
    if (std::isalnum(static_cast<unsigned char>(c)) == 0)
      words.emplace_back();
    else
      words.back() += c;
  return words;
}

// stamp.sec and stamp.nanosec, time_sec_imu and time_nanosec_imu: equal except for one word.
bool names_a_second_and_its_part(const std::string& whole, const std::string& part) {
  const std::vector<std::string> a = words_of(whole), b = words_of(part);
  if (a.size() != b.size()) return false;
  const auto [at, there] = std::mismatch(a.begin(), a.end(), b.begin());
  if (at == a.end() || !std::equal(at + 1, a.end(), there + 1)) return false;
  return (*at == "sec" || *at == "secs" || *at == "s" || *at == "seconds") && digits_of(*there) > 0;
}

// Two columns that form one time: seconds and their part, or date and time of day.
std::optional<CsvTime> joined(const TableSample& table, std::size_t first, std::size_t second) {
  const std::vector<std::string> a = filled(table.cells[first]), b = filled(table.cells[second]);
  if (a.empty() || b.empty()) return std::nullopt;
  const CsvTime out{table.header_of(first) + "+" + table.header_of(second), "s"};
  const bool day = is_date(a[0]) && a[0].find(':') == std::string::npos;
  if (day && is_date(b[0]) && b[0].find(':') != std::string::npos && b[0].find(':') < 3) return out;
  const bool named = names_a_second_and_its_part(table.names[first], table.names[second]);
  const std::vector<double> whole = numbers_in(a), parts = numbers_in(b);
  const auto is_whole = [](double v) { return v == std::floor(v); };
  const bool by_values = !table.named && whole.size() == a.size() && parts.size() == b.size() &&
                         whole.size() > 1 && whole.front() >= 9.4e8 && whole.back() < 5e9 &&
                         std::ranges::all_of(whole, is_whole) && std::ranges::all_of(parts, is_whole) &&
                         *std::ranges::max_element(parts) > 1e6 && *std::ranges::max_element(parts) < 1e9;
  return named || by_values ? std::optional(out) : std::nullopt;
}

// True if the column says something in each row in which a rate does.
bool covers(const TableSample& table, std::size_t place, const Rates& rates) {
  for (const RateCandidate& rate : rates)
    for (std::size_t row = 0; row < table.cells[place].size(); ++row)
      if (table.cells[place][row].empty() && !table.cells[rate.place][row].empty()) return false;
  return true;
}

// Resolution of the cells' text, s.
double resolution_s(const std::vector<std::string>& cells, const CsvTime& time) {
  std::size_t digits = 0;
  for (const std::string& cell : cells)
    if (const std::size_t point = cell.rfind('.'); point != std::string::npos)
      digits = std::max(digits, cell.size() - point - 1);
  return time.unit_s() * std::pow(10.0, -static_cast<double>(digits));
}

}  // namespace

std::vector<double> numbers_in(const std::vector<std::string>& cells) {
  std::vector<double> values;
  for (const std::string& cell : cells)
    if (const auto value = finite_number(cell)) values.push_back(*value);
  return values;
}

bool is_empty(const std::vector<std::string>& cells) { return !cells.empty() && filled(cells).empty(); }

bool are_numbers(const std::vector<std::string>& cells) {
  const std::size_t numbers = numbers_in(cells).size();
  return numbers > 0 && numbers == filled(cells).size();
}

std::vector<CsvTime> times_of(const TableSample& table, const Rates& rates) {
  std::vector<CsvTime> best;
  for (std::size_t i = 0; i + 1 < table.names.size(); ++i)
    if (const auto two = joined(table, i, i + 1)) best.push_back(*two);
  if (!best.empty()) return best;
  std::vector<std::size_t> places;  // of the best
  int rank = 2;
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const Words words(table.names[i]);
    int here = table.named ? rank_of(table.names[i], words) : 1;
    // For names in other languages: a unit of time, or dates, suffice.
    if (here == 0 && !words.have(Role::no_time) && (time_unit(table.unit_of(i)) || are_dates(table.cells[i])))
      here = 1;
    // Of a phone's sensors each has its own time, which rows of others lack.
    here = 2 * here + (!rates.empty() && words.first() == Words(table.names[rates[0].place]).first() ? 1 : 0);
    if (here < rank || !covers(table, i, rates)) continue;
    const auto found = candidate_at(table, i, words);
    if (!found || (!table.named && !best.empty())) continue;
    if (here > rank) best.clear(), places.clear();
    rank = here;
    // Two equal times (time of day and seconds since start): the one with the finer clock is used.
    std::size_t twin = 0;
    while (
        twin < best.size() && table.cells[places[twin]] != table.cells[i] &&
        !go_together(numbers_in(table.cells[places[twin]]), best[twin], numbers_in(table.cells[i]), *found))
      ++twin;
    if (twin == best.size())
      best.push_back(*found), places.push_back(i);
    else if (resolution_s(table.cells[i], *found) < resolution_s(table.cells[places[twin]], best[twin]) ||
             (table.names[i] == table.names[places[twin]] && !rates.empty() && i < rates[0].place))
      best[twin] = *found, places[twin] = i;  // of several sensors side by side: that of the rates
  }
  return best;
}

std::string counting_column(const TableSample& table) {
  for (std::size_t i = 0; i < table.names.size(); ++i)
    if (counts(numbers_in(table.cells[i]))) return table.names[i];
  return "";
}

bool varies(const std::vector<std::string>& cells) {
  const std::vector<double> values = numbers_in(cells);
  return !values.empty() &&
         (values.size() < 2 || std::ranges::any_of(values, [&](double v) { return v != values[0]; }));
}

bool is_whole(const std::vector<std::string>& cells) {
  const std::vector<double> values = numbers_in(cells);
  return values.size() >= kFewRows && varies(cells) &&
         std::ranges::all_of(values, [](double v) { return v == std::floor(v); });
}

int digits_of_second(const std::string& name, const std::vector<std::string>& cells) {
  if (!cells.empty() && is_date(cells[0])) return 0;
  for (const std::string& word : words_of(name))
    if (const int digits = digits_of(word); digits > 0) return digits;
  double most = 0.0;
  for (const double value : numbers_in(cells)) most = std::max(most, value);
  return most >= 1e6 ? 9 : most >= 1e3 ? 6 : 3;
}

std::string whole_times_notice(const TableSample& table, std::size_t place, const CsvTime& time) {
  const std::vector<std::string> cells = filled(table.cells[place]);
  const std::vector<double> values = numbers_in(cells);
  if (values.size() < std::max(kFewRows, cells.size()) || time.unit_s() != 1.0 ||
      !std::ranges::all_of(values, [](double t) { return t == std::floor(t); }))
    return "";
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  const bool decimals = cells[0].find('.') != std::string::npos;
  if (decimals || (step != 1.0 && (!time.unit.empty() || time_unit(table.stated_unit(place))))) return "";
  return printable(time.header) + " is whole numbers, " + shortest(step) +
         " s apart in the mean; if these are milliseconds: --time " + shell_word(time.header + ":ms") +
         (step == 1.0 ? "; if they count the rows: --sample-rate HZ" : "");
}

std::optional<DateOrder> date_order(const std::vector<std::string>& cells) {
  bool alike = true;
  for (const std::string& cell : cells) {
    int first = 0, second = 0, year = 0;
    if (std::sscanf(cell.c_str(), "%2d/%2d/%4d", &first, &second, &year) != 3) return DateOrder::either;
    if (second > 12) return DateOrder::month_first;
    if (first > 12) return DateOrder::day_first;
    alike = alike && first == second;
  }
  if (cells.empty()) return DateOrder::either;
  return alike ? std::optional(DateOrder::month_first) : std::nullopt;
}

std::optional<double> stated_rate_hz(const std::vector<std::string>& comments) {
  const auto rate_hz = stated(comments, {"outputrate", "samplerate", "samplingrate", "datarate", "updaterate",
                                         "samplefrequency", "samplingfrequency"});
  return rate_hz && *rate_hz <= 1e6 ? rate_hz : std::nullopt;
}

CsvColumn stated_scale(const std::vector<std::string>& comments) {
  CsvColumn of;
  if (const auto gyroflow = stated(comments, {"gscale"}))
    of.scale = *gyroflow, of.unit = "rad/s";
  else if (const auto epson = stated(comments, {"gyrosf"}))
    of.scale = *epson, of.unit = "deg/s";
  return of;
}

}  // namespace ifog

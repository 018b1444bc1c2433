// SPDX-License-Identifier: Apache-2.0
// Which column is the time of the rows, and in what unit.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string_view>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/columns/readings.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

constexpr double kSlowest_hz = 1.0, kFastest_hz = 10'000.0;  // range of logged gyros' sample rates
// The year 2000 and 2118, in s since 1970
constexpr double kEpochFrom_s = 9.4e8, kEpochTo_s = 4.7e9;

// True if values increase at least once in `each` steps, and hardly ever decrease. A named time may decrease
// more often, because its rows are checked one by one.
bool goes_on(const std::vector<double>& values, std::size_t each, bool named) {
  std::size_t back = 0, on = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    back += values[i] < values[i - 1] ? 1 : 0;
    on += values[i] > values[i - 1] ? 1 : 0;
  }
  return values.size() < 2 ||
         (on > 0 && each * on >= values.size() - 1 && (back <= 1 || (named && 2 * back < on)));
}

// Mean of the positive steps, because a rollover steps back and bursts have many short steps.
double mean_step(const std::vector<double>& values) {
  double forward = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) forward += std::max(0.0, values[i] - values[i - 1]);
  return forward / static_cast<double>(values.size() - 1);
}

double seconds_a(const std::string& unit) { return CsvTime{"", unit}.unit_s(); }

// By the row of units, the name, the rate stated above the table, or a convention; else "".
std::string known_unit(const TableSample& table, const TableColumn& column) {
  const Words& words = column.words;
  if (time_unit(column.unit)) return column.unit;
  const double step = mean_step(column.values);
  const auto stated_hz = stated_rate_hz(table.comments);
  for (const char* unit : {"s", "ms", "100us", "us", "ns"})
    if (stated_hz && std::abs(step * seconds_a(unit) * *stated_hz - 1.0) < 0.1) return unit;
  if (const auto scale = stated(table.comments, {"tscale"})) return shortest(*scale) + "s";  // gcsv
  // Xsens: a clock of 10 kHz; of a DOT, which sends 120 samples/s at most, of 1 MHz.
  if (words.has("sample") && words.has("time") && words.has("fine"))
    return step < 1e6 / 120.0 - 1.0 ? "100us" : "us";
  const std::string last = column.name.substr(column.name.rfind('_') + 1);
  if (time_unit(last) && !says(last, Role::no_rate)) return last;
  for (const std::string& word : words.words)
    for (const char* unit : {"s", "ms", "us", "ns"})
      if (time_unit(word) == seconds_a(unit)) return unit;
  return "";
}

// " (not named; gives 100 Hz)", and another unit in which the rows are as far apart as those of a slow log.
std::string remark_on(const CsvTime& time, double step) {
  std::ostringstream remark;
  remark.precision(4);
  remark << " (not named; gives " << 1.0 / (step * time.unit_s()) << " Hz";
  for (const char* unit : {"s", "ms", "min", "h", "d"}) {
    const double period_s = step * seconds_a(unit);
    const auto near = [=](double slow_s) { return std::abs(period_s - slow_s) < 1e-3 * slow_s; };
    if (unit == time.unit || std::ranges::none_of(std::array{1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0}, near))
      continue;
    remark << "; " << 1.0 / period_s << " Hz if it is in " << unit << ": "
           << option_for(CsvTime{time.header, unit});
    break;
  }
  return remark.str() + ")";
}

// Days of this century as spreadsheets, MATLAB and astronomers count them.
bool may_be_day(double day) {
  constexpr double kCentury_d = 36'525.0;
  return std::ranges::any_of(std::array{36'526.0, 730'486.0, 2'451'544.5},
                             [=](double day_2000) { return day >= day_2000 && day < day_2000 + kCentury_d; });
}

// The unit in which the values are times since 1970, or the only one with a plausible sample rate; else all in which
// they can be times. False: no unit has a plausible rate.
bool settle_unit(TimeCandidate& found, const TableColumn& column) {
  const std::vector<double>& values = column.values;
  std::vector<std::string> all{"s", "ms", "us", "ns"};
  if (!values.empty() && may_be_day(values.front())) all.emplace_back("d");
  // Whole seconds of a gyro increase by one at most.
  const auto leaps = [](double before, double now) { return now - before > 1.0; };
  if (column.is_whole() && std::ranges::adjacent_find(values, leaps) != values.end())
    std::rotate(all.begin(), all.begin() + 1, all.end());
  // Of a timer or a controller, at any rate.
  if (column.words.has("tick") || column.words.has("ticks")) {
    found.units = all;
    found.time.remark = "; a tick may have any length: " + option_for(CsvTime{column.header, "62.5ns"});
    return true;
  }
  const double step = values.size() < 2 ? 0.0 : mean_step(values);
  for (const std::string& unit : all) {
    const double unit_s = seconds_a(unit), rate_hz = 1.0 / (step * unit_s);
    const double first_s = values.empty() ? 0.0 : values.front() * unit_s;
    // Days are counted from other years.
    if (unit_s <= 1.0 && first_s >= kEpochFrom_s && first_s < kEpochTo_s && rate_hz > 1e-2 * kSlowest_hz &&
        rate_hz < 10.0 * kFastest_hz) {
      found.units = {unit};
      found.time.unit = unit;
      if (rate_hz < kSlowest_hz) found.time.remark = remark_on(found.time, step);
      return true;
    }
    if (rate_hz >= kSlowest_hz && rate_hz <= kFastest_hz) found.units.push_back(unit);
  }
  if (found.units.size() == 1) {
    found.time.unit = found.units.front();
    found.time.remark = remark_on(found.time, step);
    return true;
  }
  const bool plausible = !found.units.empty();
  found.units = all;
  keep_measurable(found.units, values, [](const std::string& unit) {
    return measurable_in_file(CsvTime{"", unit});
  });
  return plausible;
}

// Likelihood from its name that a column is the rows' time; 0: none.
int rank_of(const TableColumn& column) {
  const Words& words = column.words;
  if (column.name == "time_s") return 5;
  // UTC_Day, UTC_Second: parts of a date.
  const bool of_week = words.has("of") && words.has("week");  // Time of week, SecondsOfWeek
  if ((words.have(Role::no_time) && !of_week) ||
      (words.first() == "utc" && (words.has("day") || words.has("second"))))
    return 0;
  const auto is_time = [](const std::string& word) {
    return word.starts_with("time") || word.ends_with("time") || word.ends_with("stamp") ||
           says(word, Role::time);
  };
  if (words.has("header") && words.has("stamp")) return 4;  // measurement time in ROS
  if (words.size() > 0 && std::ranges::all_of(words.words, is_time)) return 3;
  if (std::ranges::any_of(words.words, is_time)) return 2;
  // For names in other languages: a unit of time, or dates, suffice.
  return time_unit(column.unit) || column.is_dates() || is_number_of_column(column.name) ? 1 : 0;
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
bool is_fraction_of_second(const TableSample& table, std::size_t place) {
  constexpr double kSecondsPerWeek = 604'800.0;
  if (table.named || place < 2) return false;
  const TableColumn &weeks = table.columns[place - 2], &seconds = table.columns[place - 1];
  if (!weeks.is_numeric() || !weeks.is_whole() || !seconds.is_numeric() || seconds.varies()) return false;
  const double week = weeks.values[0], second = seconds.values[0];
  return week > 0.0 && week < 1e4 && second > 1.0 && second < kSecondsPerWeek &&
         std::ranges::all_of(table.columns[place].values, [](double v) { return v >= 0.0 && v < 1.0; });
}

// Whole seconds may be the same in all first rows.
bool stays_in_a_second(const TableSample& table, const TableColumn& column) {
  return table.named && time_unit(column.unit) == 1.0 && column.is_whole() && !column.varies();
}

std::optional<TimeCandidate> candidate_at(const TableSample& table, std::size_t place) {
  const TableColumn& column = table.columns[place];
  if (column.is_empty()) return std::nullopt;
  TimeCandidate out{{column.header, "s"}, {"s"}};
  if (column.is_dates()) {
    // A date that is the same in all rows is no time; a time of day in whole seconds may be.
    const std::string& first = column.filled.front();
    const bool stays = column.filled.size() > 1 && first == column.filled.back();
    return stays && first.find(':') == std::string::npos ? std::nullopt : std::optional(out);
  }
  const bool other_quantity = !time_unit(column.unit) && !other_units(column.unit).empty();  // T (°C)
  // NMEA's 235959.5 is no number of seconds.
  const bool clock_digits = lower(column.name).find("hhmmss") != std::string::npos;
  // Several rows may have one stamp; without a name a quantity that hardly changes is no time.
  const std::size_t each = table.named ? column.cells.size() : kFewRows;
  if (other_quantity || clock_digits || is_fraction_of_second(table, place) ||
      column.values.size() != column.filled.size() ||
      (!goes_on(column.values, each, table.named) && !stays_in_a_second(table, column)))
    return std::nullopt;
  out.time.unit = known_unit(table, column);
  out.units = {out.time.unit};
  if (!out.time.unit.empty()) return out;
  if (column.counts_rows()) return std::nullopt;
  out.units.clear();
  return settle_unit(out, column) || table.named ? std::optional(out) : std::nullopt;
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
  return time_unit(*at) == 1.0 && time_unit(*there).value_or(1.0) <= 1e-3;
}

// Two columns that form one time: seconds and their part, or date and time of day.
bool are_one_time(const TableSample& table, const TableColumn& whole, const TableColumn& part) {
  if (whole.filled.empty() || part.filled.empty()) return false;
  const auto is_day = [](const std::string& cell) {
    return is_date(cell) && cell.find(':') == std::string::npos;
  };
  if (is_day(whole.filled[0]) && is_date(part.filled[0]) && part.filled[0].find(':') < 3) return true;
  if (table.named) return names_a_second_and_its_part(whole.name, part.name);
  if (!whole.is_numeric() || !part.is_numeric() || whole.values.size() < 2) return false;
  const double most = *std::ranges::max_element(part.values);
  return whole.is_whole() && part.is_whole() && whole.values.front() >= kEpochFrom_s &&
         whole.values.back() < kEpochTo_s && most > 1e6 && most < 1e9;
}

// True if the column says something in each row in which a rate does.
bool covers(const TableSample& table, const TableColumn& column, const Rates& rates) {
  for (const RateCandidate& rate : rates)
    for (std::size_t row = 0; row < column.cells.size(); ++row)
      if (column.cells[row].empty() && !table.columns[rate.place].cells[row].empty()) return false;
  return true;
}

// Resolution of the cells' text, s.
double resolution_s(const TableColumn& column, const CsvTime& time) {
  std::size_t digits = 0;
  for (const std::string& cell : column.cells)
    if (const std::size_t point = cell.rfind('.'); point != std::string::npos)
      digits = std::max(digits, cell.size() - point - 1);
  return time.unit_s() * std::pow(10.0, -static_cast<double>(digits));
}

}  // namespace

std::vector<TimeCandidate> times_of(const TableSample& table, const Rates& rates) {
  std::vector<TimeCandidate> best;
  for (std::size_t i = 0; i + 1 < table.columns.size(); ++i)
    if (const TableColumn& whole = table.columns[i], &part = table.columns[i + 1];
        are_one_time(table, whole, part))
      best.push_back({{whole.header + "+" + part.header, "s"}, {"s"}});
  if (!best.empty()) return best;
  std::vector<std::size_t> places;  // of the best
  int rank = 2;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const TableColumn& column = table.columns[i];
    // Of a phone's sensors each has its own time, which rows of others lack.
    const bool of_sensor =
        !rates.empty() && column.words.first() == table.columns[rates[0].place].words.first();
    const int rank_here = table.named && !stays_in_a_second(table, column) ? rank_of(column) : 1;
    const int here = rank_of(column) == 0 && table.named ? 0 : 2 * rank_here + (of_sensor ? 1 : 0);
    if (here < rank || !covers(table, column, rates)) continue;
    const auto found = candidate_at(table, i);
    if (!found || (!table.named && !best.empty())) continue;
    if (here > rank) best.clear(), places.clear();
    rank = here;
    // Two equal times (time of day and seconds since start): the one with the finer clock is used.
    std::size_t twin = 0;
    for (; twin < best.size(); ++twin) {
      const TableColumn& other = table.columns[places[twin]];
      if (other.cells == column.cells ||
          go_together(other.values, best[twin].time, column.values, found->time))
        break;
    }
    if (twin == best.size()) {
      best.push_back(*found), places.push_back(i);
      continue;
    }
    const TableColumn& other = table.columns[places[twin]];
    // Of several sensors side by side: that of the rates.
    const bool nearer = column.name == other.name && !rates.empty() && i < rates[0].place;
    if (nearer || resolution_s(column, found->time) < resolution_s(other, best[twin].time))
      best[twin] = *found, places[twin] = i;
  }
  return best;
}

int digits_of_second(const TableColumn& part) {
  if (!part.cells.empty() && is_date(part.cells[0])) return 0;
  for (const std::string& word : words_of(part.name))
    if (const auto unit_s = time_unit(word); unit_s && *unit_s <= 1e-3)
      return static_cast<int>(std::lround(-std::log10(*unit_s)));
  const double most = part.values.empty() ? 0.0 : *std::ranges::max_element(part.values);
  return most >= 1e6 ? 9 : most >= 1e3 ? 6 : 3;
}

std::string whole_times_notice(const TableColumn& column, const CsvTime& time) {
  const std::vector<double>& values = column.values;
  if (values.size() < std::max(kFewRows, column.filled.size()) || time.unit_s() != 1.0 || !column.is_whole())
    return "";
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  const bool decimals = column.filled[0].find('.') != std::string::npos;
  if (decimals || (step != 1.0 && (!time.unit.empty() || time_unit(column.stated)))) return "";
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

std::optional<double> stated_rate_hz(const std::vector<std::string>& comments) {
  const auto rate_hz = stated(comments, {"outputrate", "samplerate", "samplingrate", "datarate", "updaterate",
                                         "samplefrequency", "samplingfrequency"});
  return rate_hz && *rate_hz <= 1e6 ? rate_hz : std::nullopt;
}

}  // namespace ifog

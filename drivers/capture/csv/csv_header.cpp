// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv/csv_header.h"

#include <algorithm>
#include <cstdlib>
#include <set>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/columns/readings.h"
#include "drivers/capture/times/row_sink.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"
#include "drivers/system/shell_word.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

// The only name of a gyro among several sensors' names; else "".
std::string the_gyro(std::set<std::string> names) {
  std::erase_if(names, [](const std::string& name) { return lower(name).find("gyr") == std::string::npos; });
  return names.size() == 1 ? *names.begin() : "";
}

// Options of each reading, if none is unambiguous.
std::string options_in_words(const Readings& readings) {
  std::string text;
  for (const TableReading& way : readings.ways)
    text += (text.empty() ? "; to read it: " : "; or: ") + way.options;
  return text + readings.other_units;
}

class Chooser {
 public:
  Chooser(TableForm form, const std::string& path, const CsvLayout& layout, bool has_lines) : path_(path) {
    static_cast<TableForm&>(header_) = std::move(form);
    for (const std::string& name : header_.sample.names()) header_.cells.push_back(in_utf8(name));
    if (has_lines) line_ = header_.header_line > 0 ? header_.header_line : header_.last_line + 1;
    if (header_.layout.only_header == layout.only_header) return;
    kinds_ = "of rows of several kinds are read those of --only " +
             shell_word(header_.layout.only_header + "=" + header_.layout.only_value);
    header_.notices.push_back(kinds_);
  }

  CsvHeader choose() {
    named_ = reads_as_named();
    if (header_.layout.only_header.empty()) look_what_alternates();
    if (!header_.layout.only_value.empty()) keep_only(place(header_.layout.only_header));
    choose_columns();
    for (std::size_t i = 0; i < header_.cells.size(); ++i)
      header_.is_clock.push_back(i == header_.time_place || i == header_.time_part ||
                                 header_.sample.columns[i].increases());
    if (are_rates_of_several()) fail(kinds_);
    return std::move(header_);
  }

 private:
  // Index of a column given by its header or number ("#3").
  [[nodiscard]] std::size_t place(const std::string& wanted) const {
    const auto count = std::ranges::count(header_.cells, wanted);
    if (count == 1)
      return static_cast<std::size_t>(std::ranges::find(header_.cells, wanted) - header_.cells.begin());
    const std::size_t number =
        count == 0 && is_number_of_column(wanted) ? std::strtoul(wanted.c_str() + 1, nullptr, 10) : 0;
    if (number >= 1 && number <= header_.cells.size()) return number - 1;
    std::string numbers;
    for (std::size_t i = 0; i < header_.cells.size(); ++i)
      if (header_.cells[i] == wanted) numbers += ", #" + std::to_string(i + 1);
    fail((count == 0 ? "no column " : "more than one column ") + in_quotes(wanted) + numbers +
         ", the header has " + listed(header_.cells));
  }
  [[noreturn]] void fail(const std::string& what) const { fail_at(path_, line_, what); }

  // Rows of several sensors in turn, numbered or named by a column: if one name is a gyro's, only its rows
  // are read.
  void look_what_alternates() {
    for (const TableColumn& column : header_.sample.columns) {
      const Words& words = column.words;
      const std::vector<std::string>& cells = column.cells;
      // A topic's name may begin with a slash. A measured value is no sensor's number: "imu_gyr[1]", 0.00106.
      const bool is_text = std::ranges::all_of(
          cells, [](const std::string& cell) { return is_letter(cell.c_str()[0]) || cell.starts_with('/'); });
      if (!is_text && !(words.have(Role::one) && words.axis.empty() && column.are_counts())) continue;
      const std::set<std::string> values(cells.begin(), cells.end());
      std::size_t changes = 0;
      for (std::size_t row = 1; row < cells.size(); ++row) changes += cells[row] != cells[row - 1] ? 1 : 0;
      const std::string gyro = named_ ? "" : the_gyro(values);
      if (values.size() < 2 || values.size() > 8 || (gyro.empty() && 2 * changes < cells.size())) continue;
      const std::string said =
          in_quotes(column.name) + " is " + listed({values.begin(), values.end()}) + " in turn: ";
      const std::string& other = *values.begin() == gyro ? *values.rbegin() : *values.begin();
      const auto option = [&](const std::string& value) {
        return "--only " + shell_word(column.header + "=" + value);
      };
      if (gyro.empty()) {
        kinds_ = said + "rows of several sensors; one of them: " + option(other) +
                 "; all as of one: " + option("*");
        names_sensor_ = &column;
        continue;
      }
      header_.notices.push_back(said + "only rows of " + in_quotes(gyro) +
                                " are read; others: " + option(other));
      header_.layout.only_header = column.header;
      header_.layout.only_value = gyro;
      return;
    }
  }

  // True if rates of more than one sensor stand below each other.
  [[nodiscard]] bool are_rates_of_several() const {
    std::set<std::string> sensors;
    for (const FileColumn& column : header_.columns)
      for (std::size_t row = 0;
           names_sensor_ != nullptr && is_rate_column(column.name) && row < names_sensor_->cells.size();
           ++row)
        if (!header_.sample.columns[column.place].cells[row].empty())
          sensors.insert(names_sensor_->cells[row]);
    return sensors.size() > 1;
  }

  // Only the rows that are read are used as first rows.
  void keep_only(std::size_t place) {
    header_.only_place = place;
    header_.sample.keep_rows(place, header_.layout.only_value);
  }

  // Time first and a rate, or a table without any possible rate.
  [[nodiscard]] bool reads_as_named() const {
    if (header_.layout.chooses() || header_.cells.front() != "time_s") return false;
    if (std::ranges::any_of(header_.cells, [](const std::string& name) {
          return is_rate_column(name) || is_signal_column(name);
        }))
      return true;
    CsvLayout timed = header_.layout;
    timed.time = CsvTime{};
    return readings_of(header_.sample, timed).ways.empty();
  }

  void expect_every_name_once() const {
    std::set<std::string> seen;
    for (const std::string& name : header_.cells) {
      if (name.empty()) fail("a column has no name");
      if (!seen.insert(name).second) fail("column " + in_quotes(name) + " stands twice");
    }
    (void)under_own_name(0);
  }

  // Adds the unit from the row of units if the name has none.
  [[nodiscard]] CsvColumn under_own_name(std::size_t i) const {
    const std::string& unit = header_.sample.columns[i].stated;
    const auto name = name_with_unit(header_.cells[i], unit);
    if (!name)
      fail("the unit of " + in_quotes(header_.cells[i]) + " is given as " + in_quotes(unit) +
           ", expected that of its name; to read it so: " +
           (header_.cells[i] == CsvTime{}.header
                ? option_for(CsvTime{header_.cells[i], unit})
                : option_for(CsvColumn{header_.cells[i], header_.cells[i], ""}, unit)));
    return {*name, header_.cells[i], ""};
  }

  void choose_columns() {
    CsvLayout& layout = header_.layout;
    if (named_) expect_every_name_once();
    // With only --time, other columns keep their names.
    const bool own_names = named_ || (layout.time && layout.columns.empty() &&
                                      std::ranges::any_of(header_.cells, is_rate_column));
    if (!layout.time && !layout.sample_rate_hz && std::ranges::count(header_.cells, "time_s") == 1)
      layout.time = CsvTime{};
    if (own_names) {
      for (std::size_t i = 0; i < header_.cells.size(); ++i)
        if (header_.cells[i] != layout.time->header) layout.columns.push_back(under_own_name(i));
    } else if (layout.columns.empty() || (!layout.time && !layout.sample_rate_hz)) {
      take_reading();
    }
    if (layout.sample_rate_hz) {
      layout.time.reset();
      // Where a counter of the rows jumps, rows are missing.
      const auto& columns = header_.sample.columns;
      const auto count = std::ranges::find_if(
          columns, [](const TableColumn& column) { return column.counts_rows() && !time_unit(column.unit); });
      if (count != columns.end()) header_.time_place = static_cast<std::size_t>(count - columns.begin());
    } else {
      take_time(*layout.time);
    }
    if (const auto interval = interval_of(header_.sample, layout)) {
      header_.notices.push_back("each increment is of its own interval: " +
                                option_for(*interval, interval->unit));
      layout.columns.push_back(*interval);
    }
    if (layout.other_rates && !named_)
      for (const CsvColumn& other : rates_not_chosen(header_.sample, layout)) layout.columns.push_back(other);
    for (CsvColumn& column : layout.columns) {
      const std::size_t at = place(column.header);
      if (column.unit.empty()) column.unit = own_unit(column, at);
      if (at == header_.time_place || at == header_.time_part ||
          std::ranges::any_of(header_.columns, [at](const FileColumn& chosen) { return chosen.place == at; }))
        fail("column " + in_quotes(column.header) + " is chosen twice");
      take(at, column);
    }
  }

  // By the row of units or the name, if it becomes the capture's unit. A rate named in deg is often in deg/s.
  [[nodiscard]] std::string own_unit(const CsvColumn& chosen, std::size_t at) const {
    CsvColumn column = chosen;
    column.unit = header_.sample.columns[at].unit;
    if (column.angle_rad() && header_.sample.columns[at].stated.empty())
      fail(in_quotes(column.header) + " is in " + in_quotes(column.unit) +
           " by its name, and no unit was given; to read it so: " + option_for(column, column.unit));
    return column.angle_rad() || convert_unit(column.unit, column.own_unit()) ? column.unit : "";
  }

  // Adds what was not asked for, by names.
  void take_reading() {
    for (const CsvColumn& asked : header_.layout.columns) (void)place(asked.header);
    Readings found;
    found.why = "no name surely stands above its column";
    if (header_.unused_names == 0 || !header_.layout.columns.empty())
      found = readings_of(header_.sample, header_.layout);
    if (const TableReading* const clear = found.clear()) {
      header_.notices.push_back("read as: " + in_words(clear->layout));
      if (header_.layout.columns.empty() && header_.sample.named) tell_not_read(*clear);
      header_.layout = clear->layout;
      return;
    }
    if (found.ways.empty() && header_.sample.named) fail(no_rate_among(header_.cells));
    fail(
        without_names() + (kinds_.empty() ? "" : kinds_ + "; ") + found.why + options_in_words(found) +
        (found.ways.empty()
             ? "; --column 'rate_x_radps=#2:deg/s' and --time '#1:s' or --sample-rate HZ say which they are, "
               "with the numbers and units of this file"
             : ""));
  }

  // Names columns of numbers that are not read, except times and counts of the rows, and how one of them is read that a
  // rate table was commanded, or that names no axis.
  void tell_not_read(const TableReading& reading) {
    const std::string count = header_.sample.counting();
    std::vector<std::string> left;
    std::string rate;
    for (const TableColumn& column : header_.sample.columns) {
      const bool is_read = std::ranges::any_of(
          reading.layout.columns, [&](const CsvColumn& chosen) { return chosen.header == column.header; });
      const bool is_time = column.header == reading.layout.time.value_or(CsvTime{}).header ||
                           time_unit(column.unit) || column.words.have(Role::no_time) ||
                           column.words.have(Role::time);
      if (is_read || is_time || !column.is_numeric() || column.name == count) continue;
      left.push_back(column.header);
      const CsvColumn reference{"reference_" + reading.layout.columns.front().name, column.header, ""};
      const bool has_one = std::ranges::any_of(
          reading.layout.columns, [&](const CsvColumn& chosen) { return chosen.name == reference.name; });
      if (has_one || !column.words.have(Role::truth) || !angle_unit(column.unit, true, false)) continue;
      rate = "; as the true rate: " + reading.options + " " + option_for(reference, column.unit);
    }
    const std::size_t named = std::min<std::size_t>(left.size(), 6), more = left.size() - named;
    left.resize(named);
    if (named > 0)
      header_.notices.push_back("not read: " + listed(left) +
                                (more > 0 ? " and " + std::to_string(more) + " more" : "") + rate);
  }

  // Why columns have numbers and no names; "" if they have names.
  [[nodiscard]] std::string without_names() const {
    if (header_.sample.named || !is_number_of_column(header_.cells.front())) return "";
    const std::string cells = std::to_string(header_.cells.size());
    if (header_.unused_names == 0) return "no header line; columns are #1 to #" + cells + "; ";
    return "the header has " + std::to_string(header_.unused_names) + " names and the rows have " + cells +
           " cells, #1 to #" + cells + "; ";
  }

  void take_time(CsvTime& time) {
    const std::vector<std::string> parts = parts_of_time(time.header, [&](const std::string& name) {
      return is_number_of_column(name) || std::ranges::count(header_.cells, name) > 0;
    });
    header_.time_place = place(parts.front());
    const TableColumn& column = header_.sample.columns[header_.time_place];
    if (parts.size() > 1) {
      header_.time_part = place(parts.back());
      header_.part_digits = digits_of_second(header_.sample.columns[header_.time_part]);
    } else {
      if (time.unit.empty() && time_unit(column.unit).value_or(1.0) != 1.0) time.unit = column.unit;
      if (const std::string notice = whole_times_notice(column, time); !notice.empty())
        header_.notices.push_back(notice);
    }
    const std::optional<DateOrder> order = time.unit == kDayFirst     ? DateOrder::day_first
                                           : time.unit == kMonthFirst ? DateOrder::month_first
                                                                      : date_order(column.cells);
    header_.date_order = order.value_or(DateOrder::month_first);
    if (!order)
      header_.notices.push_back(printable(column.name) + " is " + in_quotes(column.cells[0]) +
                                " at first and read with the month first; if that is the day: " +
                                option_for(CsvTime{time.header, kDayFirst}));
  }

  void take(std::size_t at, const CsvColumn& column) {
    if (is_rate_column(column.name) && ++rates_ > kInputLimits.csv_rates)
      fail("more than " + std::to_string(kInputLimits.csv_rates) + " rates, expected at most that");
    header_.columns.push_back({column, header_.cells[at], at, measurable_in_file(column)});
  }

  CsvHeader header_;
  const std::string& path_;
  std::size_t line_ = 0;  // of the header; 0: none
  std::size_t rates_ = 0;
  std::string kinds_;                          // what is said of rows of several kinds or sensors
  const TableColumn* names_sensor_ = nullptr;  // the column that names the sensors of rows in turn
  bool named_ = false;                         // it is a capture
};

}  // namespace

CsvHeader read_csv_header(std::string_view text, const std::vector<std::string>& given,
                          const std::string& path, const CsvLayout& layout, bool has_lines) {
  return Chooser(table_form(text, given, path, layout), path, layout, has_lines).choose();
}

}  // namespace ifog

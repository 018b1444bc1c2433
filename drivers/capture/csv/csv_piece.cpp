// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv/csv_piece.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <utility>

#include "drivers/capture/checks/row_checks.h"
#include "drivers/capture/columns/column.h"
#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/text_cells.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/time_stamps.h"
#include "drivers/ifog/decimal.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

struct Unreadable {
  std::string what;
};

double number(const std::string& column, std::string_view cell, std::string_view digits) {
  if (cell.empty()) return kMissing;
  double value = 0.0;
  const auto [end, error] = read_decimal(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range) return HUGE_VAL;  // treated like infinity
  if (error != std::errc() || end != digits.data() + digits.size()) {
    if (is_no_number(cell)) return kMissing;
    throw Unreadable{printable(column) + " is " + in_quotes(cell) + ", expected a number, 'nan' or nothing"};
  }
  return value;
}

bool is_no_row(std::string_view line) { return trimmed(line).empty() || line.front() == '#'; }

std::string_view cell_at(std::string_view line, std::size_t place, char separator) {
  const auto skip_blanks = [&] {
    while (separator == ' ' && line.starts_with(' ')) line.remove_prefix(1);
  };
  skip_blanks();
  for (; place > 0 && !line.empty(); --place) {
    line.remove_prefix(std::min(cell_end(line, separator) + 1, line.size()));
    skip_blanks();
  }
  return unquoted(line.substr(0, cell_end(line, separator)));
}

// Time of a row as digits, from one or two cells: seconds and decimal digits, or date and time of day.
struct RowTime {
  std::string_view whole, part;  // cells of the present row
  std::string joined;

  // digits: of the second cell; 0: a time of day; nullopt: no second cell. Empty if the row has no time,
  // nullopt if the second cell is invalid. Valid until the next call.
  std::optional<std::string_view> text(std::optional<int> digits) {
    if (!digits || (whole.empty() && part.empty())) return whole;
    // Some loggers write integers as 570443003.0.
    for (std::string_view* cell : {&whole, &part})
      if (cell->ends_with(".0")) cell->remove_suffix(2);
    joined = whole;
    if (*digits == 0) return joined.append(" ").append(part);
    const auto wanted = static_cast<std::size_t>(*digits);
    if (part.empty() || part.size() > wanted ||
        part.find_first_not_of("0123456789") != std::string_view::npos)
      return std::nullopt;
    return joined.append(".").append(wanted - part.size(), '0').append(part);
  }
};

// Appends rows to the columns of a piece.
class Rows {
 public:
  // most: expected number of rows.
  Rows(CsvPiece& piece, const CsvHeader& header, const TimeStamps& stamps, std::size_t most)
      : piece_(piece),
        header_(header),
        separator_(header.separator),
        stamps_(stamps),
        unit_s_(header.layout.time.value_or(CsvTime{}).unit_s()) {
    piece_.rows.keep_first(0);
    piece_.rows.time_s.reserve(most);
    piece_.rows.lines.reserve(most);
    piece_.rows.cells.reserve(most);
    piece_.rows.columns.resize(header.columns.size());
    for (std::vector<double>& column : piece_.rows.columns) column.reserve(most);
    piece_.impossible.resize(header.columns.size());
    to_.resize(header.cells.size());
    for (std::size_t c = 0; c < header.columns.size(); ++c) {
      const FileColumn& column = header.columns[c];
      Fault* const impossible = is_other_rate(column.name) ? nullptr : &piece_.impossible[c];
      to_[column.place] = {column.range, &piece_.rows.columns[c], impossible};
    }
    if (header.time_place != CsvHeader::kNone) to_[header.time_place].time = &time_.whole;
    if (header.time_part != CsvHeader::kNone) to_[header.time_part].time = &time_.part;
  }

  // ended: the line is complete.
  void add(std::string_view line, std::size_t number, bool ended) {
    try {
      // "1.2e-0" is a truncated "1.2e-05".
      if (!ended &&
          (line.ends_with("e-0") || line.ends_with("e+0") || line.ends_with("E-0") || line.ends_with("E+0")))
        throw Unreadable{"ends within a number"};
      add_cells(line, number);
    } catch (const Unreadable& row) {
      drop();
      (ended ? piece_.damaged : piece_.unended).add(number, row.what);
    }
  }

 private:
  void add_cells(std::string_view line, std::size_t number) {
    const std::size_t at_place = piece_.places++;
    const char *at = line.data(), *const end = at + line.size();
    std::size_t& place = reached_ = 0;
    std::size_t cells = 0;
    for (;; ++at) {
      while (separator_ == ' ' && at != end && *at == ' ') ++at;
      // Some writers end each row with a separator.
      const std::string_view rest(at, end);
      if (place == to_.size() && rest.find(separator_) == std::string_view::npos && trimmed(rest).empty())
        break;
      if (place == to_.size())
        throw Unreadable{"more cells than the " + std::to_string(to_.size()) + " columns of the header"};
      const char* const cell = std::exchange(at, take(place, at, end, number));
      if (!header_.is_clock[place]) cells = 31 * cells + std::hash<std::string_view>()({cell, at});
      ++place;
      if (at == end) break;
    }
    if (place != to_.size())
      throw Unreadable{std::to_string(place) + " cells, expected " + std::to_string(to_.size()) +
                       " (a truncated line?)"};
    if (header_.time_place == CsvHeader::kNone) {
      piece_.rows.time_s.push_back(static_cast<double>(at_place));
    } else if (!take_time()) {
      of_another_sensor(line);
      return;
    }
    piece_.rows.lines.push_back(number);
    piece_.rows.cells.push_back(cells);
  }

  struct Place {
    Measurable range{};
    std::vector<double>* values = nullptr;  // null: not a column of the capture
    Fault* impossible = nullptr;       // null: it was not chosen, so text is a missing value and no fault
    std::string_view* time = nullptr;  // cell of a time
  };

  // Parses the cell from `at` in a row that ends at `end`; returns the cell's end.
  const char* take(std::size_t place, const char* at, const char* end, std::size_t line) {
    const Place& to = to_[place];
    if (to.values != nullptr && header_.notation.thousands != '.') {
      // Fast path: the cell is a plain number.
      double value = 0.0;
      const auto [behind, error] = std::from_chars(at, end, value);
      if (error == std::errc() && (behind == end || *behind == separator_) && to.range.holds(value))
          [[likely]] {
        to.values->push_back(value);
        return behind;
      }
    }
    const char* const behind = at + cell_end({at, end}, separator_);
    if (to.values == nullptr && to.time == nullptr) return behind;
    const std::string_view text = unquoted({at, behind});
    if (to.time != nullptr)
      *to.time = text;
    else
      keep(place, text, line);
    return behind;
  }

  // A row without a time whose other columns are empty too.
  void of_another_sensor(std::string_view line) {
    for (std::size_t i = 0; i < to_.size(); ++i)
      if (to_[i].impossible != nullptr && !cell_at(line, i, separator_).empty())
        throw Unreadable{printable(header_.cells[header_.time_place]) + " is missing, expected a time"};
    drop();
    ++piece_.untimed;
  }

  // Removes the present row's values, only as far as it was read.
  void drop() {
    const std::size_t rows = piece_.rows.lines.size();
    piece_.rows.time_s.resize(rows);
    for (std::size_t i = 0; i < reached_; ++i)
      if (to_[i].values != nullptr) to_[i].values->resize(rows);
  }

  // False: the row has no time.
  bool take_time() {
    const std::optional<std::string_view> cell = time_.text(header_.part_digits);
    if (!cell)
      throw Unreadable{printable(header_.cells[header_.time_part]) + " is no whole number of at most " +
                       std::to_string(header_.part_digits.value_or(0)) +
                       " digits, expected the part of a second"};
    const std::string_view text = *cell;
    if (text.empty()) return false;
    const std::string& name = header_.cells[header_.time_place];
    const auto date = date_time(text, header_.date_order);
    if (date && unit_s_ != 1.0)
      throw Unreadable{printable(name) + " is " + in_quotes(text) +
                       ", a date, which says its own unit, expected no other one of --time"};
    const PointDigits digits(text, header_.notation);
    const auto exact = date ? date : Decimal::parse(digits);
    std::optional<double> found = exact ? stamps_.since(*exact) : std::nullopt;
    if (!found) found = stamps_.since(date ? date->in_double() : number(name, text, digits));
    const double since = *found;
    if (std::isnan(since)) throw Unreadable{printable(name) + " is missing, expected a time"};
    if (!time_range_.holds(stamps_.origin().in_s(since)))
      throw Unreadable{
          what_no_sensor_measures(name, text, measurable_in_file(header_.layout.time.value_or(CsvTime{})))};
    piece_.rows.time_s.push_back(since);
    return true;
  }

  void keep(std::size_t place, std::string_view text, std::size_t line) {
    const Place& to = to_[place];
    const PointDigits digits(text, header_.notation);
    const double value = to.impossible != nullptr ? number(header_.cells[place], text, digits)
                                                  : finite_number(digits).value_or(kMissing);
    const bool possible = std::isnan(value) || to.range.holds(value);
    to.values->push_back(possible ? value : kMissing);
    if (!possible && to.impossible != nullptr) to.impossible->add(line, std::string(text));
  }

  CsvPiece& piece_;
  const CsvHeader& header_;
  char separator_;
  const TimeStamps& stamps_;
  double unit_s_;
  const Measurable time_range_ = measurable("time_s");
  std::vector<Place> to_;    // by cell of a row
  std::size_t reached_ = 0;  // cells of the present row
  RowTime time_;
};

}  // namespace

std::optional<TimeStamps> stamps_from(std::string_view text, const CsvHeader& header) {
  Lines lines(text);
  RowTime time;
  std::string_view line;
  while (lines.next(line)) {
    if (is_no_row(line)) continue;
    if (header.time_place == CsvHeader::kNone) return TimeStamps();
    time.whole = cell_at(line, header.time_place, header.separator);
    if (header.part_digits) time.part = cell_at(line, header.time_part, header.separator);
    const std::optional<std::string_view> first = time.text(header.part_digits);
    if (!first || first->empty()) continue;
    const auto date = date_time(*first, header.date_order);
    return TimeStamps(date ? date : Decimal::parse(PointDigits(*first, header.notation)),
                      header.layout.time.value_or(CsvTime{}).unit_s());
  }
  return std::nullopt;
}

void parse(CsvPiece& piece, const CsvHeader& header, const TimeStamps& stamps) {
  CsvPiece fresh;
  fresh.text = std::move(piece.text), fresh.rows = std::move(piece.rows);
  piece = std::move(fresh);
  piece.rows.origin = stamps.origin();
  const std::string_view text = piece.text;
  // Estimates the number of rows from the first row's length, at least one byte per column.
  const std::size_t length = std::max(std::min(text.find('\n'), text.size()) + 1, header.cells.size());
  Rows rows(piece, header, stamps, text.size() / length + text.size() / length / 16 + 1);
  Lines lines(text);
  std::string_view line;
  while (lines.next(line)) {
    if (line.size() > kLongestLine) {
      piece.too_long.add(lines.number(), std::string(line.substr(0, kLongestLine)));
      break;
    }
    if (is_no_row(line)) {
      if (line.starts_with('#')) piece.comments.append(trimmed(line.substr(1))) += '\n';
      continue;
    }
    if (header.only_place == CsvHeader::kNone ||
        cell_at(line, header.only_place, header.separator) == header.layout.only_value) {
      piece.row_bytes += line.size() + 1;
      rows.add(line, lines.number(), !lines.rest().empty() || text.ends_with('\n'));
    }
  }
  piece.lines = lines.number();
}

}  // namespace ifog

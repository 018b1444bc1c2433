// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv/csv_piece.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/date_time.h"
#include "drivers/ifog/decimal.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

// What R, pandas, databases and spreadsheets write where there is no value.
bool is_no_value(std::string_view cell) {
  constexpr std::array<std::string_view, 6> kWords{"na", "n/a", "#n/a", "null", "none", "-"};
  return std::any_of(kWords.begin(), kWords.end(), [&](std::string_view word) {
    return std::equal(cell.begin(), cell.end(), word.begin(), word.end(), [](char c, char small) {
      return (c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c) == small;
    });
  });
}

double number(const std::string& path, std::size_t line, const std::string& column, std::string_view cell,
              std::string_view digits) {
  if (cell.empty()) return kMissing;
  double value = 0.0;
  const auto [end, error] = read_decimal(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range)
    fail_at(path, line, printable(column) + " is " + in_quotes(cell) + ", outside what a double holds");
  if (error != std::errc() || end != digits.data() + digits.size()) {
    if (is_no_value(cell)) return kMissing;
    fail_at(path, line,
            printable(column) + " is " + in_quotes(cell) + ", expected a number, 'nan' or nothing");
  }
  if (std::isinf(value))
    fail_at(path, line, printable(column) + " is infinite, expected a finite number, 'nan' or nothing");
  return value;
}

bool is_no_row(std::string_view line) { return trimmed(line).empty() || line.front() == '#'; }

// A time that stands in two cells, as digits: a whole second and its digits behind the point, or a date and a
// time of day.
class JoinedTime {
 public:
  // Loggers that hold all in one kind of number write 570443003.0.
  void put(bool part, std::string_view cell) {
    if (cell.ends_with(".0")) cell.remove_suffix(2);
    (part ? part_ : whole_) = cell;
  }
  [[nodiscard]] bool is_empty() const { return whole_.empty() && part_.empty(); }
  // part_digits: of the second cell; 0: a time of day. Empty where that is no such number.
  std::string_view text(int part_digits) {
    std::string_view part = part_;
    const bool digits = !part.empty() && part.find_first_not_of("0123456789") == std::string_view::npos;
    const auto wanted = static_cast<std::size_t>(part_digits);
    if (wanted > 0 && (!digits || part.size() > wanted)) return {};
    if (whole_.size() + part.size() + wanted + 1 > room_.size()) return {};
    char* end = std::copy(whole_.begin(), whole_.end(), room_.begin());
    *end++ = wanted > 0 ? '.' : ' ';
    if (wanted > 0) end = std::fill_n(end, wanted - part.size(), '0');
    end = std::copy(part.begin(), part.end(), end);
    return {room_.data(), static_cast<std::size_t>(end - room_.data())};
  }

 private:
  std::string_view whole_, part_;
  std::array<char, 128> room_{};
};

std::string_view cell_at(std::string_view line, std::size_t place, char separator) {
  for (; place > 0 && !line.empty(); --place) {
    line.remove_prefix(std::min(cell_end(line, separator) + 1, line.size()));
    while (separator == ' ' && line.starts_with(' ')) line.remove_prefix(1);
  }
  return unquoted(line.substr(0, cell_end(line, separator)));
}

// One row after the other, into the columns of a piece.
class Rows {
 public:
  Rows(CsvPiece& piece, const CsvHeader& header, const TimeStamps& stamps, const std::string& path)
      : piece_(piece),
        header_(header),
        separator_(header.separator),
        stamps_(stamps),
        unit_s_(header.layout.time.value_or(CsvTime{}).unit_s),
        path_(path) {
    piece_.rows.columns.resize(header.names.size());
    piece_.impossible.resize(header.names.size());
    for (const CsvCell& cell : header.cells) {
      if (cell.column == CsvCell::kTime) {
        to_.push_back({header.time_part == CsvHeader::kNone ? Meaning::kTime : Meaning::kPartOfTime,
                       {},
                       nullptr,
                       nullptr});
      } else if (cell.column == CsvCell::kPassedOver) {
        to_.push_back({Meaning::kNothing, {}, nullptr, nullptr});
      } else {
        to_.push_back({is_other_rate(header.names[cell.column]) ? Meaning::kOther : Meaning::kNumber,
                       header.columns[cell.column].range,
                       cell.kept ? &piece_.rows.columns[cell.column] : nullptr,
                       &piece_.impossible[cell.column]});
      }
    }
  }

  // Columns that were used before have their memory still.
  void begin(std::size_t rows) {
    piece_.rows.time_s.clear();
    piece_.rows.time_s.reserve(rows);
    piece_.rows.lines.clear();
    piece_.rows.lines.reserve(rows);
    for (std::vector<double>& column : piece_.rows.columns) column.clear();
    for (const Place& place : to_)
      if (place.values != nullptr) place.values->reserve(rows);
  }

  // False: a row of another sensor, which leaves the time and all columns of this one empty.
  bool add(std::string_view line, std::size_t number) {
    untimed_ = false;
    const char *at = line.data(), *const end = at + line.size();
    std::size_t place = 0;
    for (;; ++at) {
      while (separator_ == ' ' && at != end && *at == ' ') ++at;
      // Some writers end each row with a separator.
      const std::string_view rest(at, end);
      if (place == to_.size() && rest.find(separator_) == std::string_view::npos && trimmed(rest).empty())
        break;
      if (place == to_.size())
        fail_at(path_, number,
                "more cells than the " + std::to_string(to_.size()) + " columns of the header");
      at = take(place, at, end, number);
      ++place;
      if (at == end) break;
    }
    if (place != to_.size())
      fail_at(
          path_, number,
          std::to_string(place) + " cells, expected " + std::to_string(to_.size()) + " (a truncated line?)");
    if (header_.time_part != CsvHeader::kNone) take_joined_time(number);
    if (header_.time_place == CsvHeader::kNone) piece_.rows.time_s.push_back(static_cast<double>(rows_));
    if (untimed_) {
      take_back(line, number);
      return false;
    }
    piece_.rows.lines.push_back(number);
    ++rows_;
    return true;
  }

 private:
  // kOther: nobody chose it, so that text in it is no fault of the file but a missing value.
  enum class Meaning : unsigned char { kNothing, kOther, kNumber, kTime, kPartOfTime };
  struct Place {
    Meaning means;
    Measurable range;
    std::vector<double>* values;  // null: nobody wants them
    ImpossibleValues* impossible;
  };

  // The cell that begins there, of the row that ends at `end`; where it ends itself.
  const char* take(std::size_t place, const char* at, const char* end, std::size_t line) {
    const Place& to = to_[place];
    if (to.means == Meaning::kNumber) {
      // Nearly every cell is a number in digits and nothing else: where they end the cell does.
      double value = 0.0;
      const char* const behind = decimal::short_number(at, end, value);
      if (behind != nullptr && (behind == end || *behind == separator_)) {
        if (to.range.holds(value)) [[likely]] {
          if (to.values != nullptr) to.values->push_back(value);
        } else {
          keep(place, value, {at, behind}, line);
        }
        return behind;
      }
    }
    const char* const behind = at + cell_end({at, end}, separator_);
    if (to.means == Meaning::kNothing) return behind;
    const std::string_view text = unquoted({at, behind});
    if (to.means == Meaning::kTime)
      take_time(place, text, line);
    else if (to.means == Meaning::kPartOfTime)
      joined_.put(place == header_.time_part, text);
    else if (to.means == Meaning::kOther)
      keep_other(to, PointDigits(text, separator_ != ','));
    else
      keep(place, number(path_, line, header_.cells[place].name, text, PointDigits(text, separator_ != ',')),
           text, line);
    return behind;
  }

  // The row that has no time.
  void take_back(std::string_view line, std::size_t number) {
    for (std::size_t i = 0; i < to_.size(); ++i) {
      if (to_[i].means == Meaning::kNumber && !cell_at(line, i, separator_).empty())
        fail_at(path_, number,
                printable(header_.cells[header_.time_place].name) + " is missing, expected a time");
      const bool value = to_[i].means == Meaning::kNumber || to_[i].means == Meaning::kOther;
      if (value && to_[i].values != nullptr) to_[i].values->pop_back();
    }
  }

  void take_joined_time(std::size_t line) {
    untimed_ = joined_.is_empty();
    if (untimed_) return;
    const std::string_view text = joined_.text(header_.part_digits);
    if (text.empty())
      fail_at(path_, line,
              printable(header_.cells[header_.time_part].name) + " is no whole number of at most " +
                  std::to_string(header_.part_digits) + " digits, expected the part of a second");
    take_time(header_.time_place, text, line);
  }

  void take_time(std::size_t place, std::string_view text, std::size_t line) {
    untimed_ = text.empty();
    if (untimed_) return;
    const TimeDigits digits(text, separator_ != ',');
    if (digits.is_date() && unit_s_ != 1.0)
      fail_at(path_, line,
              printable(header_.cells[place].name) + " is " + in_quotes(text) +
                  ", a date, which says its own unit, expected no other one of --time");
    double since = 0.0;
    if (!stamps_.since(digits, since))
      since = stamps_.since(number(path_, line, header_.cells[place].name, text, digits));
    if (std::isnan(since))
      fail_at(path_, line, printable(header_.cells[place].name) + " is missing, expected a time");
    if (!time_range_.holds(stamps_.origin().told(since)))
      fail_at(path_, line,
              what_no_sensor_measures(header_.cells[place].name, text,
                                      measurable_in_file(header_.layout.time.value_or(CsvTime{}))));
    piece_.rows.time_s.push_back(since);
  }

  static void keep_other(const Place& to, std::string_view digits) {
    double value = 0.0;
    const auto [end, error] = read_decimal(digits.data(), digits.data() + digits.size(), value);
    const bool known = error == std::errc() && end == digits.data() + digits.size() && to.range.holds(value);
    if (to.values != nullptr) to.values->push_back(known ? value : kMissing);
  }

  void keep(std::size_t place, double value, std::string_view text, std::size_t line) {
    const Place& to = to_[place];
    const bool possible = std::isnan(value) || to.range.holds(value);
    if (to.values != nullptr) to.values->push_back(possible ? value : kMissing);
    if (possible) return;
    ImpossibleValues& impossible = *to.impossible;
    if (impossible.count++ > 0) return;
    impossible.line = line;
    impossible.first = text;
  }

  CsvPiece& piece_;
  const CsvHeader& header_;
  char separator_;
  const TimeStamps& stamps_;
  double unit_s_;
  const Measurable time_range_ = measurable("time_s");
  const std::string& path_;
  std::vector<Place> to_;  // by cell of a row
  JoinedTime joined_;
  std::size_t rows_ = 0;  // that were added
  bool untimed_ = false;  // the row at hand has no time
};

}  // namespace

std::optional<TimeStamps> stamps_from(std::string_view text, const CsvHeader& header) {
  Lines lines(text);
  std::string_view line;
  while (lines.next(line)) {
    if (is_no_row(line)) continue;
    if (header.time_place == CsvHeader::kNone) return TimeStamps();
    JoinedTime joined;
    std::string_view first = cell_at(line, header.time_place, header.separator);
    if (header.time_part != CsvHeader::kNone) {
      joined.put(false, first);
      joined.put(true, cell_at(line, header.time_part, header.separator));
      first = joined.text(header.part_digits);
    }
    if (first.empty()) continue;
    return TimeStamps(TimeDigits(first, header.separator != ','),
                      header.layout.time.value_or(CsvTime{}).unit_s);
  }
  return std::nullopt;
}

CsvPiece parse_csv_piece(std::string_view text, const CsvHeader& header, const TimeStamps& stamps,
                         const std::string& path, std::size_t lines_before, RowBlock used) {
  CsvPiece piece;
  piece.rows = std::move(used);
  piece.rows.origin = stamps.origin();
  Rows rows(piece, header, stamps, path);
  // Rows are about as long as the first, and have at least a separator a column.
  const std::size_t length = std::max(std::min(text.find('\n'), text.size()) + 1, header.cells.size());
  rows.begin(text.size() / length + text.size() / length / 16 + 1);
  Lines lines(text, lines_before);
  std::string_view line;
  while (lines.next(line)) {
    if (line.size() > kLongestLine) refuse_long_line(path, lines.number(), line);
    const bool other = header.only_place != CsvHeader::kNone && !is_no_row(line) &&
                       cell_at(line, header.only_place, header.separator) != header.layout.only_value;
    if (!other && !is_no_row(line)) {
      piece.row_bytes += line.size() + 1;
      if (rows.add(line, lines.number())) continue;
      ++piece.untimed;
    }
    if (line.starts_with('#')) piece.comments.append(trimmed(line.substr(1))) += '\n';
  }
  piece.lines = lines.number() - lines_before;
  return piece;
}

}  // namespace ifog

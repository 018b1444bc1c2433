#include "drivers/capture/capture.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/capture/text_file.h"
#include "drivers/ifog/driver.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void fail(const std::string& path, std::size_t line, const std::string& what) {
  throw std::runtime_error(path + ":" + std::to_string(line) + ": " + what);
}

std::string_view trimmed(std::string_view cell) {
  while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) cell.remove_prefix(1);
  while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t' || cell.back() == '\r'))
    cell.remove_suffix(1);
  return cell;
}

// Hands out one line at a time, without its end.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++number_;
    return true;
  }
  [[nodiscard]] std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

std::vector<std::string> split_header(std::string_view line) {
  std::vector<std::string> names;
  for (;;) {
    const std::size_t comma = line.find(',');
    names.emplace_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return names;
    line.remove_prefix(comma + 1);
  }
}

// The axis of a rate column: "rate_radps" is "", "rate_x_radps" is "x". False: not such a column.
bool axis_of(const std::string& name, std::string_view prefix, std::string& axis) {
  constexpr std::string_view kUnit = "_radps";
  if (!name.starts_with(prefix) || !name.ends_with(kUnit)) return false;
  if (name.size() == prefix.size() + kUnit.size()) {
    axis.clear();
    return true;
  }
  if (name.size() < prefix.size() + kUnit.size() + 2 || name[prefix.size()] != '_') return false;
  axis = name.substr(prefix.size() + 1, name.size() - prefix.size() - kUnit.size() - 1);
  return axis.find('_') == std::string::npos;  // rate_ramp_x_radps is somebody's channel, not an axis
}

std::string shortest(double value) {
  std::array<char, 40> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

// Beyond this there is no measurement: one such cell would be all that a fit sees.
double most_of(const std::string& column) {
  constexpr double kMostTime_s = 1e10;  // 300 years, the time since 1970 included
  std::string axis;
  if (column == "time_s") return kMostTime_s;
  const bool rate = axis_of(column, "rate", axis) || axis_of(column, "reference_rate", axis);
  return rate ? IFOG_MAX_RATE : IFOG_MAX_ENVIRONMENT_VALUE;
}

double number(const std::string& path, std::size_t line, const std::string& column, double most,
              std::string_view cell) {
  cell = trimmed(cell);
  if (cell.empty()) return kMissing;
  std::string_view digits = cell;
  if (digits.front() == '+') digits.remove_prefix(1);  // from_chars takes no plus sign
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range)
    fail(path, line, printable(column) + " is " + in_quotes(cell) + ", outside what a double holds");
  if (error != std::errc() || end != digits.data() + digits.size())
    fail(path, line, printable(column) + " is " + in_quotes(cell) + ", expected a number, 'nan' or nothing");
  if (std::isinf(value))
    fail(path, line, printable(column) + " is infinite, expected a finite number, 'nan' or nothing");
  if (std::abs(value) > most)
    fail(path, line,
         printable(column) + " is " + in_quotes(cell) + ", which no sensor measures, expected at most " +
             shortest(most));
  return value;
}

void append(std::string& out, double value) {
  if (std::isnan(value)) {
    out += "nan";
    return;
  }
  std::array<char, 40> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  (void)error;  // 40 characters hold any double
  out.append(text.data(), end);
}

// The names of the columns, from the first line that is neither empty nor a comment; `line` is then that
// line.
std::vector<std::string> header(Lines& lines, std::string_view& line, const std::string& path, Table& table) {
  std::vector<std::string> names;
  while (names.empty() && lines.next(line)) {
    if (trimmed(line).empty()) continue;
    if (line.front() == '#')
      table.comments.emplace_back(trimmed(line.substr(1)));
    else
      names = split_header(line);
  }
  if (names.empty()) throw std::runtime_error(path + ": no header line, expected 'time_s,rate_radps,…'");
  table.header_line = lines.number();
  if (names.front() != "time_s")
    fail(path, lines.number(), "first column is " + in_quotes(names.front()) + ", expected 'time_s'");
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (name.empty()) fail(path, lines.number(), "a column has no name");
    if (!seen.insert(name).second) fail(path, lines.number(), "column " + in_quotes(name) + " stands twice");
  }
  return names;
}

// A column while it is read: the most that a cell of it may say, and where the cells go.
struct Cells {
  std::string name;
  double most;
  std::vector<double>* values;
};

// `text` from the header on. Rows are about as long as the first; one allocation that is large enough beats
// doubling through a long record.
void reserve_rows(std::vector<Cells>& columns, std::string_view text) {
  const std::size_t first_row = text.find('\n');
  if (first_row == std::string_view::npos) return;
  // A row has at least a separator a column: a short second line of a wide file must not ask for all memory.
  const std::size_t length = std::max(text.find('\n', first_row + 1) - first_row, columns.size());
  const std::size_t rows = length > 1 && length < text.size() ? (text.size() - first_row) / length + 1 : 1;
  for (Cells& column : columns) column.values->reserve(rows + rows / 16);
}

void add_row(std::vector<Cells>& columns, std::string_view line, const std::string& path,
             std::size_t line_number) {
  std::size_t place = 0;
  for (std::string_view rest = line;;) {
    const std::size_t comma = rest.find(',');
    if (place == columns.size())
      fail(path, line_number,
           "more cells than the " + std::to_string(columns.size()) + " columns of the header");
    const Cells& column = columns[place];
    column.values->push_back(number(path, line_number, column.name, column.most, rest.substr(0, comma)));
    ++place;
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (place != columns.size())
    fail(path, line_number,
         std::to_string(place) + " cells, expected " + std::to_string(columns.size()) +
             " (a truncated line?)");
}

}  // namespace

Table parse_table(std::string_view text, const std::string& path) {
  Table table;
  Lines lines(text);
  std::string_view line;
  const std::vector<std::string> names = header(lines, line, path, table);
  std::vector<Cells> columns;
  // Nothing is added to table.columns once the addresses are taken.
  for (std::size_t i = 1; i < names.size(); ++i) table.columns.push_back({names[i], {}});
  columns.push_back({names.front(), most_of(names.front()), &table.time_s});
  for (CaptureColumn& column : table.columns)
    columns.push_back({column.name, most_of(column.name), &column.values});
  reserve_rows(columns, text.substr(static_cast<std::size_t>(line.data() - text.data())));

  while (lines.next(line)) {
    if (trimmed(line).empty() || line.front() == '#') {
      if (line.starts_with('#')) table.comments.emplace_back(trimmed(line.substr(1)));
      table.skipped.push_back(table.time_s.size());
      continue;
    }
    add_row(columns, line, path, lines.number());
    const double now = table.time_s.back();
    if (std::isnan(now)) fail(path, lines.number(), "time_s is missing, expected seconds");
    if (table.time_s.size() > 1 && now <= table.time_s[table.time_s.size() - 2])
      fail(path, lines.number(),
           "time_s is " + printable(trimmed(line.substr(0, line.find(',')))) +
               ", expected more than in the row before");
  }
  if (table.time_s.empty()) throw std::runtime_error(path + ": no rows after the header");
  return table;
}

std::size_t line_of_row(const Table& table, std::size_t row) {
  if (table.header_line == 0) return 0;
  const auto before =
      std::upper_bound(table.skipped.begin(), table.skipped.end(), row) - table.skipped.begin();
  return table.header_line + 1 + row + static_cast<std::size_t>(before);
}

Table read_table(const std::string& path) { return parse_table(read_text_file(path), path); }

Capture read_capture(const std::string& path) { return parse_capture(read_text_file(path), path); }

Capture parse_capture(std::string_view text, const std::string& path) {
  Table table = parse_table(text, path);
  Capture capture;
  capture.comments = std::move(table.comments);
  capture.time_s = std::move(table.time_s);
  std::string axis;
  for (const CaptureColumn& column : table.columns)
    if (axis_of(column.name, "rate", axis)) capture.axes.push_back(axis);
  if (capture.axes.empty())
    fail(path, table.header_line, "no rate column, expected 'rate_radps' or 'rate_x_radps', …");
  capture.rate_radps.resize(capture.axes.size());
  capture.reference_rate_radps.resize(capture.axes.size());
  const auto index_of = [&](const std::string& name) {
    for (std::size_t i = 0; i < capture.axes.size(); ++i)
      if (capture.axes[i] == name) return i;
    fail(path, table.header_line,
         "reference column of axis " + in_quotes(name) + " has no rate column beside it");
  };
  for (CaptureColumn& column : table.columns) {
    if (axis_of(column.name, "rate", axis))
      capture.rate_radps[index_of(axis)] = std::move(column.values);
    else if (axis_of(column.name, "reference_rate", axis))
      capture.reference_rate_radps[index_of(axis)] = std::move(column.values);
    else
      capture.channels.push_back(std::move(column));
  }
  return capture;
}

void write_capture(const Capture& capture, const std::string& path) {
  std::vector<std::pair<std::string, const std::vector<double>*>> columns;
  columns.emplace_back("time_s", &capture.time_s);
  const auto named = [](const std::string& prefix, const std::string& axis) {
    return axis.empty() ? prefix + "_radps" : prefix + "_" + axis + "_radps";
  };
  for (std::size_t i = 0; i < capture.axes.size(); ++i)
    columns.emplace_back(named("rate", capture.axes[i]), &capture.rate_radps[i]);
  for (std::size_t i = 0; i < capture.reference_rate_radps.size(); ++i)
    if (!capture.reference_rate_radps[i].empty())
      columns.emplace_back(named("reference_rate", capture.axes[i]), &capture.reference_rate_radps[i]);
  for (const CaptureColumn& channel : capture.channels) columns.emplace_back(channel.name, &channel.values);

  std::string out;
  out.reserve(capture.size() * columns.size() * 16 + 256);
  for (const std::string& comment : capture.comments) out += "# " + comment + "\n";
  for (std::size_t c = 0; c < columns.size(); ++c) out += (c == 0 ? "" : ",") + columns[c].first;
  out += '\n';
  for (std::size_t row = 0; row < capture.size(); ++row) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (c != 0) out += ',';
      append(out, (*columns[c].second)[row]);
    }
    out += '\n';
  }
  write_text_file(path, out);
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <numeric>
#include <string_view>
#include <utility>

#include "drivers/capture/capture.h"
#include "drivers/capture/csv/csv_rows.h"
#include "drivers/capture/files/input_file.h"

namespace ifog {
namespace {

// Blocks become whole columns.
class TableSink final : public RowSink {
 public:
  explicit TableSink(Table& table) : table_(table) {}

  void begin(const std::vector<std::string>& names) override {
    for (const std::string& name : names) table_.columns.push_back({name, {}});
  }
  void take(RowBlock& rows) override {
    table_.origin = rows.origin;
    table_.time_s.insert(table_.time_s.end(), rows.time_s.begin(), rows.time_s.end());
    for (std::size_t c = 0; c < rows.columns.size(); ++c)
      table_.columns[c].values.insert(table_.columns[c].values.end(), rows.columns[c].begin(),
                                      rows.columns[c].end());
  }

 private:
  Table& table_;
};

}  // namespace

Table table_of(const std::function<RowNotes(RowSink&)>& read) {
  Table table;
  TableSink sink(table);
  static_cast<RowNotes&>(table) = read(sink);
  return table;
}

Table read_table(InputFile& file, const CsvLayout& layout) {
  return table_of([&](RowSink& sink) { return read_csv_rows(file, layout, sink); });
}

double median_value(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double median_step_s(const std::vector<double>& time_s) {
  if (time_s.size() < 2) return kMissing;
  std::vector<double> steps(time_s.size());
  std::adjacent_difference(time_s.begin(), time_s.end(), steps.begin());
  steps.erase(steps.begin());
  return median_value(std::move(steps));
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  for (std::size_t end = 0; !text.empty(); text.remove_prefix(end)) {
    end = std::min(text.find('\n'), text.size() - 1) + 1;
    lines.emplace_back(text.substr(0, end - (text[end - 1] == '\n' ? 1 : 0)));
  }
  return lines;
}

void RowBlock::append(RowBlock& rows) {
  if (size() == 0) return std::swap(*this, rows);
  time_s.insert(time_s.end(), rows.time_s.begin(), rows.time_s.end());
  lines.insert(lines.end(), rows.lines.begin(), rows.lines.end());
  for (std::size_t c = 0; c < columns.size(); ++c)
    columns[c].insert(columns[c].end(), rows.columns[c].begin(), rows.columns[c].end());
}

void RowBlock::move_row(std::size_t from, std::size_t to) {
  if (from == to) return;
  time_s[to] = time_s[from];
  if (!lines.empty()) lines[to] = lines[from];
  for (std::vector<double>& column : columns)
    if (!column.empty()) column[to] = column[from];
}

void RowBlock::keep_first(std::size_t rows) {
  time_s.resize(rows);
  if (!lines.empty()) lines.resize(rows);
  for (std::vector<double>& column : columns)
    if (!column.empty()) column.resize(rows);
}

void RowNotes::add_lines(std::size_t rows, const RowBlock& block) {
  for (std::size_t i = 0; i < block.lines.size(); ++i)
    if (lines.empty() || block.lines[i] - lines.back().line != rows + i - lines.back().row)
      lines.push_back({rows + i, block.lines[i]});
}

std::size_t RowNotes::line_of_row(std::size_t row) const {
  const auto behind =
      std::upper_bound(lines.begin(), lines.end(), row,
                       [](std::size_t wanted, const Lines& each) { return wanted < each.row; });
  return behind == lines.begin() ? 0 : std::prev(behind)->line + (row - std::prev(behind)->row);
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <iterator>
#include <string_view>
#include <utility>

#include "drivers/capture/capture.h"
#include "drivers/capture/csv_rows.h"
#include "drivers/capture/input_file.h"

namespace ifog {
namespace {

// Blocks become whole columns.
class TableSink final : public RowSink {
 public:
  // bytes: of the text that is to come, 0 where that is not known.
  TableSink(Table& table, std::size_t bytes) : table_(table), bytes_(bytes) {}

  void begin(const std::vector<std::string>& names) override {
    for (const std::string& name : names) table_.columns.push_back({name, {}});
  }
  void take(RowBlock& rows) override {
    if (table_.time_s.empty() && bytes_ > kCsvPiece) reserve(rows.size());
    table_.origin = rows.origin;
    table_.time_s.insert(table_.time_s.end(), rows.time_s.begin(), rows.time_s.end());
    for (std::size_t c = 0; c < rows.columns.size(); ++c)
      table_.columns[c].values.insert(table_.columns[c].values.end(), rows.columns[c].begin(),
                                      rows.columns[c].end());
  }

 private:
  // One allocation that is large enough beats doubling through a long record.
  void reserve(std::size_t rows_a_piece) {
    const std::size_t rows = rows_a_piece * (bytes_ / kCsvPiece + 1);
    table_.time_s.reserve(rows + rows / 16);
    for (CaptureColumn& column : table_.columns) column.values.reserve(rows + rows / 16);
  }

  Table& table_;
  std::size_t bytes_;
};

}  // namespace

Table table_of(const std::function<RowNotes(RowSink&)>& read) {
  Table table;
  TableSink sink(table, 0);
  static_cast<RowNotes&>(table) = read(sink);
  return table;
}

Table parse_table(std::string_view text, const std::string& path, const CsvLayout& layout) {
  std::string_view rest = text;
  const auto read = [&rest](char* to, std::size_t most) {
    const std::size_t n = std::min(most, rest.size());
    std::memcpy(to, rest.data(), n);
    rest.remove_prefix(n);
    return n;
  };
  Table table;
  TableSink sink(table, text.size());
  static_cast<RowNotes&>(table) = read_csv_rows(read, path, layout, sink);
  return table;
}

Table read_table(InputFile& file, const CsvLayout& layout) {
  return table_of([&](RowSink& sink) { return read_csv_rows(file, layout, sink); });
}

std::size_t RowNotes::line_of_row(std::size_t row) const {
  std::size_t raw = row;
  for (const Repeated& each : repeated) {
    if (each.row > raw) break;
    raw += each.rows;
  }
  return line_of_raw_row(raw);
}

std::size_t RowNotes::line_of_raw_row(std::size_t row) const {
  if (header_line == 0) return 0;
  const auto behind = std::upper_bound(skipped.begin(), skipped.end(), row,
                                       [](std::size_t wanted, const Skipped& s) { return wanted < s.row; });
  return header_line + 1 + row + (behind == skipped.begin() ? 0 : std::prev(behind)->lines);
}

}  // namespace ifog

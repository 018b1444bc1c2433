// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/checks/row_checks.h"

#include <algorithm>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
std::string what_no_sensor_measures(const std::string& name, std::string_view cell, const Measurable& range) {
  return printable(name) + " is " + in_quotes(cell) + ", which no sensor measures, expected " +
         shortest(range.least) + " to " + shortest(range.most);
}

RowChecks::RowChecks(const std::string& path, const CsvLayout& layout, std::vector<FileColumn> columns,
                     RowSink& sink, RowNotes& notes)
    : path_(path),
      layout_(layout),
      columns_(std::move(columns)),
      sink_(sink),
      notes_(notes),
      clock_(path, layout.time.value_or(CsvTime{}).header, layout.keep_repeats, notes,
             [this](RowBlock& rows) { behind_clock(rows); }) {
  if (std::any_of(layout.columns.begin(), layout.columns.end(),
                  [](const auto& c) { return c.angle_rad().has_value(); }))
    all_.emplace();
}

void RowChecks::take(RowBlock& rows) {
  if (layout_.chooses()) convert(rows, layout_);
  rows_ += rows.size();
  clock_.take(rows);
}

void RowChecks::behind_clock(RowBlock& rows) {
  notes_.add_lines(given_, rows);
  given_ += rows.size();
  if (!all_) return sink_.take(rows);
  all_->append(rows);
}

void RowChecks::finish(std::span<const Fault> found) {
  for (std::size_t c = 0; c < columns_.size(); ++c) tell_impossible(columns_[c], found[c]);
  clock_.finish();
  if (!all_) return;
  as_rates(*all_, layout_, notes_, path_);
  sink_.take(*all_);
}

void RowChecks::tell_impossible(const FileColumn& column, const Fault& found) {
  if (found.count == 0) return;
  const std::string what = what_no_sensor_measures(column.name, found.first, column.range);
  const bool few = found.count == 1 || kRowsAFault * found.count <= rows_;
  if (column.rate && (rows_ == 1 || !few)) {
    std::string more =
        found.count > 1 ? "; nor " + std::to_string(found.count - 1) + " more of its cells" : "";
    if (found.first.find_first_not_of("+-0123456789") == std::string::npos)
      more += "; counts are read by their scale: --column 'rate_x_radps=" + printable(column.name) +
              ":0.00763deg/s'";
    fail_at(path_, found.line, what + more);
  }
  notes_.faults.push_back(path_ + ":" + std::to_string(found.line) + ": " + what + "; " +
                          std::to_string(found.count) + (found.count == 1 ? " such cell" : " such cells") +
                          " treated as missing");
}

}  // namespace ifog

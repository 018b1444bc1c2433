// SPDX-License-Identifier: Apache-2.0
// What is done to the rows of every format between parser and sink: chosen columns are converted, angles become
// rates, and values that no sensor measures become missing and are reported, or are refused.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/checks/row_clock.h"
#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/columns/measurable.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

// "rate_radps is '1e9', which no sensor measures, expected …".
std::string what_no_sensor_measures(const std::string& name, std::string_view cell, const Measurable& range);

class RowChecks {
 public:
  // columns: in the order of the names that the sink was given. The path, the layout, the sink and the notes
  // stay where they are while this is used.
  RowChecks(const std::string& path, const CsvLayout& layout, std::vector<FileColumn> columns, RowSink& sink,
            RowNotes& notes);

  // The next rows in the file's units, at least one. Throws std::runtime_error with one line, as finish().
  void take(RowBlock& rows);
  // found: of each column, values that no sensor measures. A few such values are faults of the logger and
  // become missing. A rate with more than one in a hundred is not what its name says and is refused. A
  // channel only becomes missing, because a broken thermometer does not make the rate useless.
  void finish(std::span<const Fault> found);

  // Rows received, repeated ones included.
  [[nodiscard]] std::size_t rows() const { return rows_; }

 private:
  void tell_impossible(const FileColumn& column, const Fault& found);
  void behind_clock(RowBlock& rows);

  const std::string& path_;
  const CsvLayout& layout_;
  const std::vector<FileColumn> columns_;
  RowSink& sink_;
  RowNotes& notes_;
  RowClock clock_;
  std::optional<RowBlock> all_;  // where angles become rates
  std::size_t rows_ = 0;
  std::size_t given_ = 0;  // rows behind the clock
};

}  // namespace ifog

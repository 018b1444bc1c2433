// SPDX-License-Identifier: Apache-2.0
// Checks between parser and sink, common to all formats: chosen columns are converted, angles become rates,
// impossible values become missing with a report, or the file is rejected.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/checks/row_clock.h"
#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

// "rate_radps is '1e9', which no sensor measures, expected …".
std::string what_no_sensor_measures(const std::string& name, std::string_view cell, const Measurable& range);

// Tells if rows come at another rate from some time on. Analyses assume an even clock, and a device that is set to
// another output rate, or a logger, may change it in a recording.
class RowRate {
 public:
  void take(const RowBlock& rows);
  // "rows come at 100 Hz until 12.5 s and at 105 Hz from there on: …"; "" for one rate, up to 1 %.
  [[nodiscard]] std::string change_in_words() const;

 private:
  TimeOrigin origin_;
  std::vector<double> times_;                // of the present window
  std::vector<double> begins_s_, period_s_;  // of each window before
};

class RowChecks {
 public:
  // columns: in the order of the sink's names. Sink and notes must outlive this object.
  RowChecks(const CsvLayout& layout, std::vector<FileColumn> columns, RowSink& sink, RowNotes& notes);

  // Takes the next rows in the file's units, at least one. Throws std::runtime_error with one line, as
  // finish() does.
  void take(RowBlock& rows);
  // found: impossible values by column. Few are faults of the logger and become missing. A rate with more
  // than 1 % is rejected, because its name must be wrong. A channel only becomes missing.
  void finish(std::span<const Fault> found);

  // Rows received, including repeated ones.
  [[nodiscard]] std::size_t rows() const { return rows_; }

 private:
  void tell_impossible(const FileColumn& column, const Fault& found);
  void behind_clock(RowBlock& rows);

  const std::vector<FileColumn> columns_;
  RowSink& sink_;
  RowNotes& notes_;
  RowClock clock_;
  RowRate rate_;
  std::optional<RowBlock> all_;  // used if angles become rates
  std::size_t rows_ = 0;
  std::size_t given_ = 0;  // rows after the clock
};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// A capture of any length: its columns in memory while they are short, and beyond in files without a name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/capture/times/row_sink.h"
#include "filters/rest/channel_outline.h"
#include "filters/rest/cleaned_rate.h"
#include "filters/rest/value_faults.h"
#include "filters/series/long_series.h"
#include "filters/series/series_view.h"

namespace ifog::tools {

struct LongColumn {
  std::string name;
  LongSeries values;
  bool known = false;                    // ever a value
  std::vector<ValueFault> repeats = {};  // of a rate; see clean()
};

struct LongTable : RowNotes {
  TimeOrigin origin;  // that time_s is counted from
  LongSeries time_s;
  std::vector<std::string> header;     // all that the file has but time_s, but for dead_axes
  std::vector<LongColumn> columns;     // of those that are wanted, in the same order
  std::vector<std::string> dead_axes;  // of the sensor, whose columns were dropped: they never have a value
  bool outlined = false;               // set before reading: unwanted columns are kept as outlines
  std::vector<ChannelOutline> outlines;

  [[nodiscard]] std::size_t size() const { return time_s.size(); }
  [[nodiscard]] std::vector<std::string> names() const;
  // Drops axes and channels of a recording that never had a value. Throws std::runtime_error where nothing is
  // left.
  void drop_unknown(const std::string& path);
  // What the rule (filters/rest/cleaned_rate.h) finds in the rates is missing from here on.
  using Rule = void(LongSeries& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults);
  void clean(Rule rule);
  // The same, printed on standard error; path: of the capture.
  void clean_and_tell(Rule rule, const std::string& path);
  // Of a table that was merged from sensors of different rates (a gyro in every fourth row, empty cells between) only
  // the rows with a rate are kept, each with the channels' latest values since the one before: a rate's clock is of
  // its own samples. Nothing where rates stand in neighbouring rows, be there holes. Adds a notice. path: of the
  // capture.
  void keep_rate_rows(const std::string& path);
  // The axes of rates that never had one, whose columns are gone from here on, with their references.
  std::vector<std::string> drop_dead_axes();
};

// A capture that is there as a whole.
LongTable long_table(Capture capture);

// Puts rows into a table: the columns that `wanted` says yes to, all where it is empty.
class LongTableSink final : public RowSink {
 public:
  using Wanted = std::function<bool(const std::string& name)>;
  explicit LongTableSink(LongTable& table, Wanted wanted = {}) : table_(table), wanted_(std::move(wanted)) {}

  void begin(const std::vector<std::string>& names) override;
  [[nodiscard]] bool wants(std::size_t column) const override;
  void take(RowBlock& rows) override;

 private:
  LongTable& table_;
  Wanted wanted_;
  std::vector<std::size_t> from_, outlined_;  // by column and by outline of the table: that of the rows
};

// Some rows of a table's columns at a time, in the order in which a capture is written: rates, references,
// channels.
class LongRows {
 public:
  // Both have to outlive this.
  LongRows(const LongTable& table, const CaptureShape& shape);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }  // time_s first
  // The next rows, by name; false at the end. Valid until the next call.
  bool next();
  [[nodiscard]] std::span<const std::span<const double>> rows() const { return rows_; }
  [[nodiscard]] const TimeOrigin& origin() const { return table_.origin; }
  // The same as a capture of so many rows, whose columns keep their places.
  void as_capture(Capture& piece) const;

 private:
  const LongTable& table_;
  const CaptureShape& shape_;
  std::vector<std::string> names_;
  std::vector<SeriesView> views_;
  std::vector<std::size_t> from_;  // by name but the first: the table's column
  std::vector<std::vector<double>> room_;
  std::vector<std::span<const double>> rows_;
  std::size_t at_ = 0;
};

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
// A capture of any length; long columns are in unnamed files.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/capture/times/row_sink.h"
#include "filters/rest/channel_outline.h"
#include "filters/rest/cleaned_rate.h"
#include "filters/rest/value_faults.h"
#include "filters/series/samples.h"

namespace ifog::tools {

struct LongColumn {
  std::string name;
  Samples values;
  bool known = false;                    // has had a value
  std::vector<ValueFault> repeats = {};  // in a rate; see clean()
};

struct LongTable : RowNotes {
  TimeOrigin origin;  // of time_s
  Samples time_s;
  std::vector<std::string> header;     // all columns of the file except time_s and dead_axes
  std::vector<LongColumn> columns;     // the wanted ones, in the same order
  std::vector<std::string> dead_axes;  // axes that never have a value; their columns are dropped
  bool outlined = false;               // set before reading: keep outlines of unwanted columns
  std::vector<ChannelOutline> outlines;

  [[nodiscard]] std::size_t size() const { return time_s.size(); }
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] const LongColumn* column(
      const std::string& name) const;  // null: it has none, or it was not read
  // Drops axes and channels of a recording that never had a value. Throws std::runtime_error if none is left.
  void drop_unknown(const std::string& path);
  // Removes the values that the rule (filters/rest/cleaned_rate.h) finds in the rates.
  using Rule = void(Samples& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults);
  void clean(Rule rule);
  // The same, and prints them on standard error; path: of the capture.
  void clean_and_tell(Rule rule, const std::string& path);
  // For a table merged from sensors of different rates, e.g. a gyro in every fourth row: keeps only rows with
  // a rate, with the channels' latest values. Then the clock is that of the rates. Prints so on
  // standard error. Does nothing if rates are in adjacent rows. path: of the capture.
  void keep_rate_rows(const std::string& path);
  // Drops the axes that never have a rate, with their references; returns them.
  std::vector<std::string> drop_dead_axes();
};

// Converts a complete capture.
LongTable long_table(Capture capture);

// Writes rows into a table: the columns for which `wanted` is true; empty: all.
class LongTableSink final : public RowSink {
 public:
  using Wanted = std::function<bool(const std::string& name)>;
  explicit LongTableSink(LongTable& table, Wanted wanted = {}) : table_(table), wanted_(std::move(wanted)) {}

  void begin(const std::vector<std::string>& names) override;
  void take(RowBlock& rows) override;

 private:
  LongTable& table_;
  Wanted wanted_;
  std::vector<std::size_t> from_, outlined_;  // column of the rows, by column and by outline of the table
};

}  // namespace ifog::tools

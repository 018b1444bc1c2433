// SPDX-License-Identifier: Apache-2.0
// A capture: recorded data of a sensor as columns. CSV with optional `#` lines, and a header: first time_s,
// then rate_radps or rate_x_radps … per axis, optionally reference_rate_radps per axis, and environment
// channels NAME_UNIT. Empty or `nan` means missing. `.gz` is read and written through zlib.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/row_sink.h"
#include "drivers/capture/times/time_stamps.h"

namespace ifog {

struct CaptureColumn {
  std::string name;            // as in the header
  std::vector<double> values;  // NaN: missing
};

struct Capture {
  std::vector<std::string> comments;                      // without the '#'
  std::vector<double> time_s;                             // strictly increasing, never NaN
  std::vector<std::string> axes;                          // "x", "y", "z", or one "" for a single-axis sensor
  std::vector<std::vector<double>> rate_radps;            // by axis
  std::vector<std::vector<double>> reference_rate_radps;  // by axis; empty vectors if there is none
  std::vector<CaptureColumn> channels;                    // all other columns
  std::vector<std::string> dead_axes;  // axes of the sensor that were dropped because they never have a value
  std::vector<std::string> notices;    // of the reader, about ambiguous content
  std::vector<std::string> faults;     // cells read as missing, one line per column
  std::optional<double> since_power_up_s;  // of the sensor at the first row, if known
  TimeOrigin origin;                       // of time_s

  [[nodiscard]] std::size_t size() const { return time_s.size(); }
};

// All columns of a file under their own names. A rate is not required: `ifog denoise` writes files without
// one.
struct Table : RowNotes {
  TimeOrigin origin;  // of time_s
  std::vector<double> time_s;
  std::vector<CaptureColumn> columns;  // all but time_s, in the file's order
};

// Collects blocks into whole columns.
class TableSink : public RowSink {
 public:
  explicit TableSink(Table& table) : table_(table) {}
  void begin(const std::vector<std::string>& names) override;
  void take(RowBlock& rows) override;

 private:
  Table& table_;
};

// Table of the rows that `read` delivers to its sink.
Table table_of(const std::function<RowNotes(RowSink&)>& read);

// Converts a table. Throws std::runtime_error with one line: no rate, a reference without its rate.
Capture capture_of(Table table, const std::string& path);

// A table needs no rate column.
Table read_table(InputFile& file, const CsvLayout& layout = {});

// The same for a driver's samples, without axes and channels that never have a value. Throws if nothing is left.
Capture known_part_of(Table table, const std::string& path);

// Roles of the columns with these names in a capture.
struct CaptureShape {
  struct Place {
    enum class Kind { rate, reference, channel } kind;
    std::size_t at;  // axis, or channel
  };
  std::vector<std::string> axes;
  std::vector<Place> places;  // by column
  std::size_t channels = 0;
};
// notes: for messages. Throws std::runtime_error with one line: no rate, a reference without its rate.
CaptureShape capture_shape(const std::vector<std::string>& names, const std::string& path,
                           const RowNotes& notes);

}  // namespace ifog

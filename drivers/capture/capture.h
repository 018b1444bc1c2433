// SPDX-License-Identifier: Apache-2.0
// A capture: what a sensor recorded, as columns. CSV with optional `#` lines, a header whose first column is
// time_s, then rate_radps or rate_x_radps … per axis, optionally reference_rate_radps per axis, and
// environment channels NAME_UNIT. Empty or `nan` is missing. `.gz` is read and written through zlib.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
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
  std::vector<std::vector<double>> reference_rate_radps;  // by axis, an empty vector where there is none
  std::vector<CaptureColumn> channels;                    // every other column
  std::vector<std::string> dead_axes;                     // of the sensor, dropped: they never have a value
  std::vector<std::string> notices;                       // of the reading: what may be meant otherwise
  std::vector<std::string> faults;                        // cells read as missing, one line a column
  std::optional<double> since_power_up_s;  // of the sensor at the first row, where that is known
  TimeOrigin origin;                       // that time_s is counted from

  [[nodiscard]] std::size_t size() const { return time_s.size(); }
};

// All columns of a file under their own names. A rate is not needed: `ifog denoise` writes files without one.
struct Table : RowNotes {
  TimeOrigin origin;  // that time_s is counted from
  std::vector<double> time_s;
  std::vector<CaptureColumn> columns;  // all but time_s, in the file's order
};

// Throws std::runtime_error with one line: file, line, column, value, what was expected.
// Refused: no time_s first, no rate column, time that does not increase, a cell that is no number, a line
// with another number of cells, a .gz that ends early, a column of which more than one cell in a hundred says
// what no sensor measures. Fewer such cells are missing, see measurable.h, and listed in `faults`.
// `layout` says what a file means that is no capture by its header; where a header is nearly one, the message
// has the options to type.
Capture read_capture(const std::string& path);

// The same of a text already at hand; `path` stands for the file in messages. A table needs no rate column.
Table read_table(InputFile& file, const CsvLayout& layout = {});
// The table of the rows that `read` delivers into its sink.
Table table_of(const std::function<RowNotes(RowSink&)>& read);
Capture parse_capture(std::string_view text, const std::string& path, const CsvLayout& layout = {});

// The capture in a table. Throws std::runtime_error with one line: no rate, a reference without its rate.
Capture capture_of(Table table, const std::string& path);

// What the columns of these names are to a capture.
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

// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv/csv_writer.h"

#include <cmath>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/text_cells.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {
namespace {

bool is_large_time(double time_s) {
  constexpr double kMost = 9e18;  // whole seconds in 64 bits
  return std::abs(time_s) >= kFineTimes_s && std::abs(time_s) < kMost;
}

}  // namespace

CsvWriter::CsvWriter(const std::string& path, const std::string& comments,
                     const std::vector<std::string>& names)
    : file_(path) {
  for (const std::string& comment : lines_of(comments)) text_ += "# " + comment + "\n";
  for (std::size_t c = 0; c < names.size(); ++c)
    text_ +=
        (c == 0 ? "" : ",") + (names[c].find(',') == std::string::npos ? names[c] : '"' + names[c] + '"');
  text_ += '\n';
  file_.write(text_);
}

void CsvWriter::rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin) {
  text_.clear();
  for (std::size_t row = 0; row < columns.front().size(); ++row) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (c != 0) text_ += ',';
      // Large times are written in full: 1763000000 instead of 1.763e+09.
      if (c == 0 && (origin != TimeOrigin{} || is_large_time(columns[c][row])))
        append_time(text_, origin, columns[c][row]);
      else
        append_shortest(text_, columns[c][row]);
    }
    text_ += '\n';
  }
  file_.write(text_);
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// One rate of a capture as it was logged, and what `ifog allan` makes of it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "filters/allan/stretches.h"
#include "filters/rest/rest.h"
#include "filters/series/series_view.h"
#include "tools/ifog/allan/allan_record.h"
#include "tools/ifog/captures/table/long_table.h"

namespace ifog::tools {

// For a line of text.
std::string six_digits(double value);

// Where a row stands in its file: "file:line", or the sample's number where the file is no text.
class Gaps {
 public:
  Gaps(std::string file, const RowNotes& lines, std::size_t first_row)
      : file_(std::move(file)), lines_(lines), first_row_(first_row) {}
  [[nodiscard]] std::string place(std::size_t row) const {
    const std::size_t line = lines_.line_of_row(row + first_row_);
    return line > 0 ? file_ + ":" + std::to_string(line)
                    : file_ + ": sample " + std::to_string(row + first_row_);
  }

 private:
  std::string file_;
  const RowNotes& lines_;
  std::size_t first_row_;
};

// A rate as it was logged: its name in the file, the times of its rows, and where the sensor rested.
// time_s: since the origin.
struct LoggedRate {
  const std::string& capture;
  std::string column;
  const TimeOrigin& origin;
  const SeriesView& time_s;
  const SeriesView& rate;
  std::span<const ValueFault> repeats;  // which are missing in it
  const SampleClock& clock;
  const Gaps& gaps;
  std::span<const ChannelOutline> channels;  // of the file, whose rows begin `first_row` before these
  std::size_t first_row = 0;

  [[nodiscard]] double told_time_s(std::size_t row) const { return origin.told(time_s.at(row)); }
};

// Its deviations, noise terms and changes, over what is at rest. Throws std::runtime_error with one line for
// people.
AllanRecord analyse(const LoggedRate& logged, const std::string& signal, const std::string& axis,
                    const Rest& rest, const AllanOptions& options);

}  // namespace ifog::tools

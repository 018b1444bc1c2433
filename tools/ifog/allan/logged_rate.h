// SPDX-License-Identifier: Apache-2.0
// One rate of a capture as it was logged, and what `ifog allan` makes of it.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "filters/allan/stretches.h"
#include "filters/rest/rest.h"
#include "filters/series/series_view.h"
#include "tools/ifog/allan/allan_record.h"
#include "tools/ifog/captures/table/long_table.h"

namespace ifog::tools {

// For a line of text.
std::string six_digits(double value);

// The part of a capture that is analysed, and what holds for all of its rates.
struct AnalysedPart {
  const std::string& capture;  // its file
  const LongTable& table;
  TimePart::Rows rows;  // of the table
  SeriesView time_s;    // of these rows, since the table's origin
  SampleClock clock;
  Rest rest = {};
  std::string slow_turns = {};  // what the reader should know of turns that stay in; "" for nothing

  // For messages, of one of its rows.
  [[nodiscard]] double told_time_s(std::size_t row) const { return table.origin.in_s(time_s.at(row)); }
  // "file:line", or the sample's number where the file is no text.
  [[nodiscard]] std::string place(std::size_t row) const;
};

// A rate as it was logged.
struct LoggedRate {
  const AnalysedPart& of;
  std::string column;
  SeriesView rate;                      // in the part's rows
  std::span<const ValueFault> repeats;  // which are missing in it
};

// Its deviations, noise terms and changes, over what is at rest. Throws std::runtime_error with one line for
// people.
AllanRecord analyse(const LoggedRate& logged, const std::string& signal, const std::string& axis,
                    const Rest& rest, const AllanOptions& options);

}  // namespace ifog::tools

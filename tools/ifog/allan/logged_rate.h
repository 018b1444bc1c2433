// SPDX-License-Identifier: Apache-2.0
// One rate of a capture as logged, and its analysis by `ifog allan`.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "filters/allan/stretches.h"
#include "filters/rest/rest.h"
#include "tools/ifog/allan/allan_record.h"
#include "tools/ifog/captures/table/long_table.h"

namespace ifog::tools {

std::string six_digits(double value);

// The part of a capture that is analysed, with the properties that all of its rates share.
struct AnalysedPart {
  const std::string& capture;  // its file
  const LongTable& table;
  TimePart::Rows rows;             // in the table
  std::span<const double> time_s;  // of these rows, since the table's origin
  SampleClock clock;
  Rest rest = {};
  std::string slow_turns = {};  // note about turns that remain; "" if none

  // For messages; `row` counts in the part.
  [[nodiscard]] double shown_time_s(std::size_t row) const { return table.origin.in_s(time_s[row]); }
  // "file:line", or the sample's number if the file is not text.
  [[nodiscard]] std::string place(std::size_t row) const;
};

// A rate as logged.
struct LoggedRate {
  const AnalysedPart& of;
  std::string column;
  std::span<const double> rate;         // in the part's rows
  std::span<const ValueFault> repeats;  // repeated values, missing in `rate`
};

// Deviations, noise terms and changes of the noise, at rest. Throws std::runtime_error with one line.
AllanRecord analyse(const LoggedRate& logged, const std::string& signal, const std::string& axis,
                    const Rest& rest, const AllanOptions& options);

}  // namespace ifog::tools

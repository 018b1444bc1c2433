// SPDX-License-Identifier: Apache-2.0
// Results of `ifog allan` for one rate, made from a column of a capture, and their picture.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/columns/column_names.h"
#include "filters/allan/confidence.h"
#include "filters/allan/noise/noise_coefficients.h"
#include "filters/allan/stretches.h"
#include "filters/allan/theo1.h"
#include "filters/rest/rest.h"
#include "filters/rest/value_faults.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/captures/table/long_table.h"
#include "tools/report/chart.h"
#include "tools/report/coefficients.h"

namespace ifog::tools {

using report::named_coefficients;
using report::NamedCoefficient;

struct AllanOptions {
  std::string axis;           // only this axis; all if empty
  std::vector<double> tau_s;  // as requested; log-spaced if empty
  int per_decade = 20;
  double confidence = 0.683;
  Deviation kind = Deviation::kAllan;
  bool refuse_gaps = false;
  bool minus_reference = false;
  bool long_tau = false;     // Thêo1 beyond the Allan variance's τ
  bool keep_motion = false;  // do not restrict the analysis to rest
  TimePart part;
};

struct AllanRecord {
  std::string capture;  // file
  std::string axis;
  // "rate", "error" (rate minus reference); in a denoised file "raw", "compensated", "denoised"
  std::string signal;
  double sample_rate_hz = 0.0;
  std::size_t samples = 0, missing = 0, gaps = 0, longest = 0;
  double mean_radps = 0.0;
  std::vector<double> tau_s;
  std::vector<DeviationPoint> points;
  std::vector<AllanInterval> intervals;
  std::vector<LongPoint> longer;  // Thêo1, if requested
  std::optional<NoiseCoefficients> fit;
  std::vector<NoiseChange> noise_changes;
  std::vector<ValueFault> findings;  // faults of the logger in the values
  double trusted_tau_s = 0.0;        // the deviation is accurate to 25 % up to here
  std::vector<std::string> notes;    // one line each

  [[nodiscard]] std::string label() const;  // short; unique in a run only with `capture`
};

// One record for each rate column of the file. Throws std::runtime_error with one line.
std::vector<AllanRecord> allan_records(const std::string& name, const LongTable& table,
                                       const AllanOptions& options);
// True if the column is analysed.
bool allan_wants(const std::string& column);

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
  const LongColumn& column;
  std::string signal, axis;           // as in AllanRecord
  std::span<const double> rate = {};  // in the part's rows

  [[nodiscard]] std::string name() const { return of_axis(signal, axis); }
};

// Deviations, noise terms and changes of the noise, at rest. Throws std::runtime_error with one line.
AllanRecord analyse(const LoggedRate& logged, const Rest& rest, const AllanOptions& options);

std::string six_digits(double value);

// Logarithmic axes, confidence bands and the fitted noise terms.
report::Chart allan_chart(const std::string& title, const std::vector<AllanRecord>& records);
void draw_allan(const std::string& path, const std::vector<AllanRecord>& records);

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
// What the chain says of each sample, on its way into the file: written as it comes, and kept only where
// something looks at all of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filters/chain/incrementer.h"
#include "filters/chain/signal_chain.h"
#include "filters/series/samples.h"
#include "tools/ifog/captures/table/column_writer.h"
#include "tools/ifog/captures/time_part.h"
#include "tools/ifog/denoise/moments.h"

namespace ifog::tools {

struct DenoisedAxis {
  Samples raw, compensated, denoised, variance;
  Samples smoothed, smoothed_variance;  // empty unless asked for
};

// Whole columns, for a picture and for smoothing.
struct DenoisedColumns {
  Samples time_s, dt_s;
  std::vector<DenoisedAxis> axes;
};

class DenoisedRows {
 public:
  struct Counts {
    std::uint64_t gated = 0, stale = 0, out_of_range = 0, ramp_unknown = 0, unknown_noise = 0;
  };
  struct AxisMoments {
    Moments raw, compensated, denoised;
    std::size_t missing = 0;       // rows without a raw value
    double first_missing_s = 0.0;  // the time of the first of them
    std::size_t stuck = 0;         // rows in which the sensor repeats one value, as the chain judges it
  };

  // Writes what of it is in `part`, CSV or HDF5 by the name. keep: the columns as well; smooth: write nothing
  // before finish().
  DenoisedRows(std::string output, TimePart part, bool keep, bool smooth);

  // Once, before the first sample.
  void begin(const std::vector<std::string>& axes);
  // That all times are counted from; before the first sample.
  void count_from(const TimeOrigin& origin) { origin_ = origin; }
  [[nodiscard]] const TimeOrigin& origin() const { return origin_; }
  // Whether it is in the part.
  bool add(double time_s, const Increment& increment, const ChainOutput& out);
  // What was kept, of all rows: smoothing fills its last two columns. After the last sample.
  [[nodiscard]] DenoisedColumns& columns() { return columns_; }
  // Ends the rows of the part. name: the capture's. Throws
  // std::runtime_error with one line when there are none, or none with a value, or as OutputFile does.
  void finish(const std::string& name);

  [[nodiscard]] std::size_t written() const { return extent_.written; }
  // All figures are of the rows in the part.
  // Not one was filtered: the noise was known too late, or never.
  [[nodiscard]] bool none_filtered() const { return counts_.unknown_noise == extent_.written; }
  [[nodiscard]] const Counts& counts() const { return counts_; }
  [[nodiscard]] const AxisMoments& moments(std::size_t axis) const { return moments_[axis]; }

 private:
  void append(double value);
  void end_row();
  void flush();
  void count(const ChainOutput& out);

  std::string output_;
  std::optional<ColumnWriter> file_;
  TimePart part_;
  bool keep_, smooth_;
  std::vector<std::string> axes_;
  std::vector<std::vector<double>> held_;  // by column: rows that are written together
  std::size_t place_ = 0;                  // of the next value in its row
  DenoisedColumns columns_;
  std::vector<AxisMoments> moments_;
  Counts counts_;
  struct Extent {
    std::size_t rows = 0, written = 0;
    double first_s = 0.0, last_s = 0.0;
    bool over = false;  // beyond the part
  } extent_;
  TimeOrigin origin_;
};

}  // namespace ifog::tools

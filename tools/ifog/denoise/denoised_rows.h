// SPDX-License-Identifier: Apache-2.0
// Writes the chain's output in blocks; keeps all rows only for a picture or for smoothing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filters/chain/incrementer.h"
#include "filters/chain/signal_chain.h"
#include "filters/series/samples.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/captures/table/column_writer.h"
#include "tools/ifog/denoise/model_trial.h"
#include "tools/ifog/denoise/moments.h"
#include "tools/ifog/denoise/offline_chain.h"

namespace ifog::tools {

struct DenoisedAxis {
  Samples raw, compensated, denoised, variance;
  Samples smoothed, smoothed_variance;  // empty unless requested
};

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
    double first_missing_s = 0.0;  // time of the first of them
    std::size_t stuck = 0;         // rows in which the chain finds that the sensor repeats one value
  };

  // Writes the rows in `part`, CSV or HDF5 by the name. keep: keeps the columns, and writes nothing before
  // finish(); smooth: the same with the rows outside of `part`, and with the smoothed columns.
  DenoisedRows(std::string output, TimePart part, bool keep, bool smooth);

  // Compares with the reference rate of this capture too; it must outlive this.
  void follow(const CaptureView& capture) { reference_trial_.follow(capture); }
  // Call it once, before the first sample.
  void begin(const std::vector<std::string>& axes, const OfflineSettings& settings);
  // Sets the origin of all times, always the same; before the first sample.
  void count_from(const TimeOrigin& origin) { origin_ = origin; }
  [[nodiscard]] const TimeOrigin& origin() const { return origin_; }
  // True if the sample is in the part.
  bool add(double time_s, const Increment& increment, const ChainOutput& out);
  // The kept columns, after the last sample; smoothing fills the last two. After finish() those of the part.
  [[nodiscard]] DenoisedColumns& columns() { return columns_; }
  // Ends the rows of the part. name: of the capture. Throws std::runtime_error with one line if there are
  // none or none has a value, or as OutputFile does.
  void finish(const std::string& name);

  [[nodiscard]] std::size_t written() const { return extent_.written; }
  // All figures are those of the rows in the part.
  // True if no row was filtered because the noise was not known in time.
  [[nodiscard]] bool none_filtered() const { return counts_.unknown_noise == extent_.written; }
  [[nodiscard]] const Counts& counts() const { return counts_; }
  [[nodiscard]] const AxisMoments& moments(std::size_t axis) const { return moments_[axis]; }
  // Of the settings' model.
  [[nodiscard]] ModelTrial& model_trial() { return model_trial_; }
  [[nodiscard]] const ModelTrial& model_trial() const { return model_trial_; }
  [[nodiscard]] const ReferenceTrial& reference_trial() const { return reference_trial_; }

 private:
  // In the order of the file.
  std::vector<Samples*> written_columns();
  // Writes the rows in columns_.
  void write();
  void count(const ChainOutput& out);

  std::string output_;
  std::optional<ColumnWriter> file_;
  TimePart part_;
  bool keep_, smooth_;
  DenoisedColumns columns_;  // the rows of the next write; if they are kept, of all
  std::vector<AxisMoments> moments_;
  Counts counts_;
  struct Extent {
    std::size_t rows = 0, written = 0;
    std::size_t kept_before = 0;  // rows before the part, for smoothing
    double first_s = 0.0, last_s = 0.0;
    bool over = false;  // after the end of the part
  } extent_;
  TimeOrigin origin_;
  ModelTrial model_trial_;
  ReferenceTrial reference_trial_;
};

}  // namespace ifog::tools

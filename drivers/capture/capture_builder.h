// SPDX-License-Identifier: Apache-2.0
// Builds a capture's rows from a driver's samples: rates in rad/s over a time axis in seconds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/times/row_sink.h"
#include "drivers/capture/times/sample_times.h"
#include "drivers/ifog/driver.h"

namespace ifog {

// Times are from SampleTimes. As in the daemon, a rate at full scale or beyond the possible range becomes
// NaN. A delta angle becomes a rate over its own sample period, also after a gap; an angle becomes a rate
// over the time since the sample before, so the first one has none. NaN also for axes marked invalid and for
// environment values that are not in the sample or impossible (Measurable).
class CaptureBuilder {
 public:
  // The sink receives rows in blocks: rates by axis, then channels; must outlive this. outside: names of channels
  // that are not in the frames.
  CaptureBuilder(const ifog_description& description, RowSink& sink,
                 const std::vector<std::string>& outside = {});

  // Throws std::runtime_error with one line if time does not increase: the sample's number, both times, the
  // cause. outside: new values of those channels since the sample before, NaN if none.
  void add(const ifog_sample& sample, std::span<const double> outside = {});

  // See SampleTimes.
  void discontinuity() { times_.discontinuity(); }
  // Changes the driver's options from the next sample on, which does not continue the samples before. Throws
  // std::runtime_error with one line if the columns would change.
  void go_on_as(const ifog_description& description);
  void allow_restarts() { times_.allow_restarts(); }
  void keep_stamps(std::optional<std::int64_t> zero_ns) { times_.keep_stamps(zero_ns); }

  // Hands on the last rows.
  void finish() { batch_.hand_on(); }

  // One line for each count that is not 0: samples missing, repeated, from two devices, invalid.
  [[nodiscard]] std::vector<std::string> remarks() const;
  [[nodiscard]] const SampleCounts& counts() const { return times_.counts(); }

 private:
  double believable(std::size_t channel, double value);
  void add_rates(const ifog_sample& sample, const SampleTimes::Stamped& stamped);
  void hold_to_what_can_be(const ifog_sample& sample);

  ifog_description description_;
  SampleTimes times_;
  RowBatch batch_;
  std::vector<double> row_, before_;  // by column; and the row before
  ifog_sample last_{};
  std::size_t impossible_ = 0, at_full_scale_ = 0, implausible_ = 0;
  std::vector<Measurable> channel_range_;
};

// Lines about samples without a rate, one for each count that is not 0: at full scale, beyond the possible
// range, and missing by a clock that may have been set.
std::vector<std::string> not_measured_in_words(std::size_t at_full_scale, std::size_t implausible,
                                               std::size_t ambiguous);

}  // namespace ifog

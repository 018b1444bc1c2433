// SPDX-License-Identifier: Apache-2.0
// From the samples a driver delivers to a capture: rates in rad/s on a time axis in seconds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/capture/columns/measurable.h"
#include "drivers/capture/times/row_sink.h"
#include "drivers/capture/times/sample_times.h"
#include "drivers/ifog/driver.h"

namespace ifog {

// Time: SampleTimes.
// As in the daemon a rate that reaches the driver's full scale, or is one that no sensor measures, is NaN.
// A delta angle becomes a rate over its own sample period, also behind a gap; an angle over the time since
// the sample before, so the first sample has none. Axes the device marks invalid and environment values that
// did not come with the sample, or are beyond what their unit can be (measurable.h), are NaN.
class CaptureBuilder {
 public:
  // outside: names of channels that did not come in the frames.
  explicit CaptureBuilder(const ifog_description& description, const std::vector<std::string>& outside = {});

  // Throws std::runtime_error with one line when time does not go on: the sample's number, both times, the
  // cause. outside: values of those channels that came since the sample before, NaN where none did.
  void add(const ifog_sample& sample, std::span<const double> outside = {});

  // As of SampleTimes.
  void discontinuity() { times_.discontinuity(); }
  // The driver's options change with the next sample, which does not continue the samples before. Throws
  // std::runtime_error with one line if the columns would change.
  void go_on_as(const ifog_description& description);
  void allow_restarts() { times_.allow_restarts(); }
  void keep_stamps(std::optional<std::int64_t> zero_ns) { times_.keep_stamps(zero_ns); }

  // The columns in the order of next_rows(): rates by axis, then channels.
  [[nodiscard]] std::vector<std::string> names() const;
  // The number of rows since the last call of next_rows(), which moves them out.
  [[nodiscard]] std::size_t waiting() const { return capture_.size(); }
  void next_rows(RowBlock& rows);

  // Drops axes and channels that never had a value. Throws std::runtime_error if nothing is left.
  Capture finish();

  // What of the samples was missing, repeated, of two devices or invalid: one line for each count that is not 0.
  [[nodiscard]] std::vector<std::string> remarks() const;
  [[nodiscard]] const SampleCounts& counts() const { return times_.counts(); }

 private:
  double believable(std::size_t channel, double value);
  void add_rates(const ifog_sample& sample, const SampleTimes::Stamped& stamped);
  void hold_to_what_can_be(const ifog_sample& sample);

  ifog_description description_;
  SampleTimes times_;
  Capture capture_;
  ifog_sample last_{};
  std::size_t impossible_ = 0, at_full_scale_ = 0, implausible_ = 0;
  std::vector<Measurable> channel_range_;
};

// What every command says about samples without a rate: at full scale, beyond what a sensor measures, and missing
// by a clock that may have been set instead. One line for each count that is not 0.
std::vector<std::string> not_measured_in_words(std::size_t at_full_scale, std::size_t implausible,
                                               std::size_t ambiguous);

// Passes the rows of a builder to a sink, some thousand at a time.
class BuiltRows {
 public:
  BuiltRows(CaptureBuilder& builder, RowSink& sink) : builder_(builder), sink_(sink) {
    sink_.begin(builder.names());
  }
  // After each sample.
  void added() {
    if (builder_.waiting() >= kRows) hand_on();
  }
  void finish() {
    if (builder_.waiting() > 0) hand_on();
  }

 private:
  static constexpr std::size_t kRows = std::size_t{1} << 14U;
  void hand_on() {
    builder_.next_rows(rows_);
    sink_.take(rows_);
  }

  CaptureBuilder& builder_;
  RowSink& sink_;
  RowBlock rows_;
};

}  // namespace ifog

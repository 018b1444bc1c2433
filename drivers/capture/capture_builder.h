// SPDX-License-Identifier: Apache-2.0
// From the samples a driver delivers to a capture: rates in rad/s on a time axis in seconds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/capture/measurable.h"
#include "drivers/capture/row_sink.h"
#include "drivers/ifog/device_timeline.h"
#include "drivers/ifog/driver.h"

namespace ifog {

// Time, the first of these that the samples have:
//   - the device's clock, over its wraps, and over where it was set while the device counted on;
//   - the sequence counter, unwrapped, over the nominal rate, from 0;
//   - the arrival times, from 0;
//   - the number of the sample over the nominal rate.
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

  // What comes next does not join what came: its clock and counter may have begun anew. The arrival times,
  // which must be known, say how much later it is.
  void discontinuity() { broken_ = true; }
  // The driver's options are others from the next sample on, which does not join what came. Throws
  // std::runtime_error with one line where the columns would not be the same.
  void go_on_as(const ifog_description& description);
  // From here on a device whose clock jumps back has begun anew, also where that clock does not go round:
  // else that cannot be told from a wrong driver, and is refused. A sample that came twice, or late, is left
  // out either way.
  void allow_restarts() { restarts_ = true; }

  // The columns in the order of next_rows(): rates by axis, then channels.
  [[nodiscard]] std::vector<std::string> names() const;
  // Rows that wait to be taken away, and their taking: for who does not want the whole at the end.
  [[nodiscard]] std::size_t waiting() const { return capture_.size(); }
  void next_rows(RowBlock& rows);

  // Leaves out axes and channels that never had a value. Throws std::runtime_error if nothing is left.
  Capture finish();

  [[nodiscard]] std::size_t impossible() const { return impossible_; }  // values left out so
  // Samples that were not there by the device's counter, or by its clock where it has none.
  [[nodiscard]] std::size_t missing() const { return missing_; }
  // Times the counter or the clock jumped back, without a discontinuity: the device was switched off and on.
  [[nodiscard]] std::size_t restarts() const { return restarted_; }
  // Times the device's clock was set while its counter went on: time goes on by that.
  [[nodiscard]] std::size_t clock_sets() const { return clock_sets_; }
  // Samples left out because they came twice, or after one that follows.
  [[nodiscard]] std::size_t repeated() const { return repeated_; }
  // Samples with a rate taken for missing: at full scale; or beyond what the driver interface allows.
  [[nodiscard]] std::size_t at_full_scale() const { return at_full_scale_; }
  [[nodiscard]] std::size_t implausible() const { return implausible_; }

 private:
  enum class Clock { undecided, device, counter, arrival, number };
  void choose_clock(const ifog_sample& sample);
  DeviceTimeline::Step step_to(const ifog_sample& sample);
  [[nodiscard]] double seconds(const ifog_sample& sample) const;
  void begin_anew(const ifog_sample& sample);
  double believable(std::size_t channel, double value);
  void refuse(double now) const;
  void add_rates(const ifog_sample& sample, double elapsed, double period);
  void hold_to_what_can_be(const ifog_sample& sample);

  ifog_description description_;
  Capture capture_;
  Clock clock_ = Clock::undecided;
  ifog_sample last_{};
  DeviceTimeline timeline_;
  std::int64_t device_ns_ = 0;  // the device's clock at the sample at hand, over its wraps
  std::uint64_t count_ = 0;     // the unwrapped counter, or the number of the sample
  std::int64_t first_arrival_ns_ = 0;
  TimeOrigin device_from_;  // of the device's clock, that its times are counted from
  std::size_t missing_ = 0, repeated_ = 0, restarted_ = 0, clock_sets_ = 0, impossible_ = 0,
              at_full_scale_ = 0, implausible_ = 0;
  std::vector<Measurable> channel_range_;
  std::size_t taken_ = 0;  // rows, by next_rows()
  double last_s_ = 0.0;    // time of the last row
  bool broken_ = false, restarts_ = false;
  double offset_s_ = 0.0;  // of the clock since the last discontinuity
};

// In the words of every command: samples whose rate reaches the full scale, and whose rate no sensor
// measures. One line each, none for none.
std::vector<std::string> not_measured_in_words(std::size_t at_full_scale, std::size_t implausible);

// Hands what a builder has made to a sink, some thousand rows at a time.
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

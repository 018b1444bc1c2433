// SPDX-License-Identifier: Apache-2.0
// The inverse of a recording: a capture as the frames that a device would have sent, by its driver's encoder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/host/driver_instance.h"

namespace ifog {

// Samples a second: one over the median time step, to seven digits. 0 for a single row.
double sample_rate_hz(const Capture& capture);

// The same of a median step that is known.
double sample_rate_hz(double step_s);

// The driver's settings with `rate_hz` set from the capture's, where that is known (not 0), the driver has
// that option and nobody set it.
DriverSettings with_rate(double rate_hz, const Plugin& plugin, DriverSettings settings);

// Rows become samples in order. The rate is turned into the driver's kind: a delta angle over the sample
// period, or an angle that sums up and wraps. The counter counts sample periods, so that missing rows are a
// gap in it. A first time before 0, which no device's clock and no log shows, moves all by whole seconds; a
// notice says so. Environment columns go by their name; what is missing in a row is held from the row before.
class CaptureEncoder {
 public:
  // A capture of one axis goes to the driver's axis `axis`, or to its first when that is empty; several axes
  // go by their names. Throws std::runtime_error: an axis the driver does not have. Keeps references to both.
  // rate_hz: sample_rate_hz() of the capture, or of all that it is to be a piece of.
  CaptureEncoder(const Capture& capture, DriverInstance& driver, double rate_hz,
                 const std::string& axis = {});

  // The caller has replaced the rows of the capture by those that follow.
  void go_on();

  // One line for the columns that the format cannot carry, and one for the fields that the capture lacks.
  [[nodiscard]] const std::vector<std::string>& notices() const { return notices_; }

  // The next row, encoded and appended. False after the last row. Throws std::runtime_error with the row's
  // time and what it cannot express.
  bool next(std::vector<std::uint8_t>& bytes);
  bool next(std::vector<ifog_can_frame>& frames);

  [[nodiscard]] std::size_t rows_done() const { return rows_.before + rows_.at; }
  // Rows without a rate in a format that cannot mark one as invalid: not sent, which leaves a gap in the counter.
  [[nodiscard]] std::size_t rows_left_out() const { return rows_.dropped; }
  // Time in s that a reader of the frames cannot see: without a clock in the format, time is the counter over the
  // nominal rate, and complete rollovers of the counter are invisible. Positive: the reader's time is too short;
  // negative: too long. 0 if the format, or a log of its frames, carries times.
  [[nodiscard]] double time_lost_s() const { return timed_ ? 0.0 : elapsed_s_ - told_s_; }
  [[nodiscard]] double elapsed_s() const { return elapsed_s_; }  // from the first row to the last
  [[nodiscard]] double rate_hz() const { return rate_hz_; }      // that the frames are read by
  // Rows whose rate reaches the driver's full scale. They are sent, and a reader treats them as missing.
  [[nodiscard]] std::size_t rows_at_full_scale() const { return rows_.at_full_scale; }

 private:
  template <typename Out>
  bool encode_next(Out& out, void (DriverInstance::*encode)(const ifog_sample&, Out&));
  ifog_sample next_sample();

  const Capture& capture_;
  DriverInstance& driver_;
  std::vector<std::size_t> axis_of_;                  // by the capture's axis: the driver's
  std::vector<const std::vector<double>*> channels_;  // by the driver's environment channel, null: not there
  std::vector<std::string> notices_;
  std::vector<double> angle_;  // by the capture's axis
  std::int64_t later_s_ = 0;   // whole seconds that are added to every time, for none to be before 0
  ifog_sample sample_{};
  struct Rows {
    std::size_t at = 0, before = 0;  // in this piece; in those before it
    std::size_t dropped = 0, at_full_scale = 0;
  } rows_;
  double before_s_ = 0.0;                  // time of the row before
  double elapsed_s_ = 0.0, told_s_ = 0.0;  // since the first row, by the capture and by the format
  bool timed_ = false;
  std::uint64_t count_ = 0;
  double rate_hz_ = 0.0;
};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// Encodes a capture as the frames that a device would have sent, with its driver's encoder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/host/driver_instance.h"

namespace ifog {

// Settings with `rate_hz` from the capture, if it has two rows, the driver has this option and the user did not set
// it.
DriverSettings with_rate(const CaptureView& capture, const Plugin& plugin, DriverSettings settings);

// Converts rows to samples in order. The rate becomes a delta angle over the sample period, or an angle that
// sums up and wraps, as the driver needs. The counter counts sample periods, so missing rows are a gap in it.
// If the first time is negative, all times are shifted by whole seconds, with a notice. Environment columns
// are matched by name; missing values repeat the last one.
class CaptureEncoder {
 public:
  // axis: driver's axis for a capture of one axis, "" for its first; several axes are matched by name. Throws
  // std::runtime_error for an axis that the driver does not have. The columns and the driver must outlive this.
  CaptureEncoder(CaptureView capture, DriverInstance& driver, const std::string& axis = {});

  // One line for columns that the format cannot carry, and one for fields that the capture lacks.
  [[nodiscard]] const std::vector<std::string>& notices() const { return notices_; }

  // Encodes and appends the next row. False after the last one. Throws std::runtime_error with the row's time
  // and the value that cannot be encoded.
  bool next(std::vector<std::uint8_t>& bytes);
  bool next(std::vector<ifog_can_frame>& frames);

  [[nodiscard]] std::size_t rows_done() const { return rows_.at; }
  // Rows without a rate, if the format cannot mark them invalid: not sent, so the counter has a gap.
  [[nodiscard]] std::size_t rows_left_out() const { return rows_.dropped; }
  // Time in s that a reader of the frames cannot recover: without a clock, time is the counter / nominal
  // rate, and complete rollovers are invisible. Positive: the reader's time is too short. 0 if the format, or
  // a log of its frames, carries times.
  [[nodiscard]] double time_lost_s() const { return timed_ ? 0.0 : elapsed_s_ - encoded_s_; }
  [[nodiscard]] double elapsed_s() const { return elapsed_s_; }  // from the first row to the last
  [[nodiscard]] double rate_hz() const { return rate_hz_; }      // rate assumed by a reader
  // Rows whose rate reaches the driver's full scale. They are sent, but a reader treats them as missing.
  [[nodiscard]] std::size_t rows_at_full_scale() const { return rows_.at_full_scale; }

 private:
  template <typename Out>
  bool encode_next(Out& out, void (DriverInstance::*encode)(const ifog_sample&, Out&));
  ifog_sample next_sample();

  const CaptureView capture_;
  DriverInstance& driver_;
  std::vector<std::size_t> axis_of_;  // driver's axis, by the capture's axis
  // By the driver's environment channel; empty: not in the capture
  std::vector<std::span<const double>> channels_;
  std::vector<std::string> notices_;
  std::vector<double> angle_;  // by the capture's axis
  std::int64_t later_s_ = 0;   // seconds added to all times, so that none is negative
  ifog_sample sample_{};
  struct Rows {
    std::size_t at = 0, dropped = 0, at_full_scale = 0;
  } rows_;
  double before_s_ = 0.0;                     // time of the previous row
  double elapsed_s_ = 0.0, encoded_s_ = 0.0;  // since the first row, by the capture and by the format
  bool timed_ = false;
  std::uint64_t count_ = 0;
  double rate_hz_ = 0.0;
};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// Status message of one sensor (1 Hz), and the counters whose changes are logged.
#pragma once

#include <cstdint>
#include <ifog/status_t.hpp>
#include <string>
#include <vector>

#include "daemon/health/sensor_watch.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/recorder/recorder.h"

namespace ifog {

// Rate in Hz from a counter that is read from time to time: from the last reading if it grew by many, else
// over the last ten events.
class CountedRate {
 public:
  // count: not decreasing; interval_s: since the previous reading, > 0; expected_hz > 0.
  double of(std::int64_t count, double interval_s, double expected_hz) noexcept {
    const auto more = static_cast<double>(count - last_count_);
    last_count_ = count;
    if (expected_hz * interval_s >= kMany) return more / interval_s;
    since_s_ += interval_s;
    quiet_s_ += interval_s;
    counted_ += more;
    if (more > 0.0) {
      // Average between arrivals; needs 10 samples except before the first estimate.
      const bool many = counted_ >= kMany;
      if (!known_ || many) rate_hz_ = began_ ? counted_ / since_s_ : more / quiet_s_;
      if (!began_ || many) counted_ = since_s_ = 0.0;
      known_ = known_ || (began_ && many);
      began_ = true;
      quiet_s_ = 0.0;
    } else if (quiet_s_ * expected_hz > kSilent && quiet_s_ > 2.0) {
      rate_hz_ = counted_ = since_s_ = 0.0;
      began_ = known_ = false;
    }
    return rate_hz_;
  }

 private:
  static constexpr double kMany = 10.0;
  static constexpr double kSilent = 3.0;  // periods without an event after which the rate is zero

  std::int64_t last_count_ = 0;
  double counted_ = 0.0, since_s_ = 0.0, quiet_s_ = 0.0, rate_hz_ = 0.0;
  bool began_ = false, known_ = false;
};

class StatusReport {
 public:
  StatusReport(std::string sensor, std::vector<std::string> channels, const std::vector<std::string>& axes,
               double sample_rate_hz);

  // Updates from the present counters and the filter's last snapshot with its accounts; interval_s: since the
  // last call.
  const ifog::status_t& update(const Pipeline& pipeline, const FilterSnapshot& snapshot, double interval_s);
  // The same for the flight recorder, before update().
  void update(Recorder& recorder);
  // Fault counters that changed in the last update(): "frames_crc +3, sequence_gaps +1", or "".
  [[nodiscard]] std::string moved() const;

  // Once, some seconds after the first sample, if an axis never had a value; else "".
  [[nodiscard]] std::string unseen_axes() const;

  // Once, after a minute of samples, if the noise has not been learned: what to do; else "".
  [[nodiscard]] std::string unknown_noise() const;

  // Once, if a device repeats itself; else "".
  [[nodiscard]] std::string newly_frozen() const;

  // Once, if a device with a counter and no clock has another rate than configured: the resulting error of
  // intervals (and of the angle, if it sends a rate); else "".
  [[nodiscard]] std::string wrong_rate() const;

  // Text on what the last update() noticed for the first time, or "".
  [[nodiscard]] std::string newly_noticed() const;
  // Restarts learning of the sensor's usual behaviour.
  void renew_watch() { watch_.renew(); }

  // Counts a logged warning of the transport.
  void count_warning() { ++now_.transport_warnings; }
  [[nodiscard]] const ifog::status_t& message() const { return now_; }

 private:
  void take_books(const ReaderBooks& read, const FilterBooks& filtered);
  void take_health(const FilterSnapshot& snapshot);
  void look_for_samples(const ReaderBooks& read);
  [[nodiscard]] std::int32_t state_of(const Pipeline& pipeline, const ReaderBooks& read) const;
  [[nodiscard]] bool nothing_in_file(const Pipeline& pipeline) const;
  [[nodiscard]] std::string fault_of_samples(bool mixed);

  ifog::status_t before_, now_;
  SensorWatch watch_;
  // As of the last update().
  struct Samples {
    std::uint64_t axes_seen = 0;
    bool news = false;                           // there were new ones
    int seconds = 0;                             // number of updates with new ones
    std::int64_t first_look_ns = 0;              // monotonic time of the first update
    std::int64_t last_ns = 0;                    // monotonic time of the last update with new ones
    bool frozen = false, frozen_before = false;  // all samples repeat earlier ones
  } samples_;
  std::vector<std::string> axes_;
  double nominal_rate_hz_;
  CountedRate input_rate_, output_rate_;
  double interval_error_ = 0.0, interval_error_before_ = 0.0;
  int in_vain_ = 0;  // consecutive updates with received data but without any good frame
};

}  // namespace ifog

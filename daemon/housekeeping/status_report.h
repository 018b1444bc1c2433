// SPDX-License-Identifier: Apache-2.0
// Status message of one sensor (1 Hz), and the counters whose changes are logged.
#pragma once

#include <cstdint>
#include <ifog/status_t.hpp>
#include <string>
#include <vector>

#include "daemon/health/counted_rate.h"
#include "daemon/health/sensor_watch.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/recorder/recorder.h"

namespace ifog {

class StatusReport {
 public:
  StatusReport(std::string sensor, std::vector<std::string> channels, const std::vector<std::string>& axes,
               double sample_rate_hz);

  // Updates from the present counters and the filter's last snapshot with its accounts; interval_s: since the
  // last call.
  const ifog::status_t& update(Pipeline& pipeline, const FilterSnapshot& snapshot, double interval_s);
  // The same for the flight recorder, before update().
  void update(Recorder& recorder);
  // Fault counters that changed in the last update(): "frames_crc +3, sequence_gaps +1", or "".
  [[nodiscard]] std::string moved() const;

  // Once, some seconds after the first sample, if an axis never had a value; else "".
  [[nodiscard]] std::string unseen_axes() const;

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
  void take_books(const FilterSnapshot& snapshot);
  void take_line(const TransportCounters& line);
  void take_counters(const ReaderCounters& reader, const FilterCounters& filter);
  void take_health(const FilterSnapshot& snapshot);
  void look_for_samples(const ReaderCounters& reader);
  [[nodiscard]] std::int32_t state_of(const Pipeline& pipeline);
  [[nodiscard]] bool nothing_in_file(const Pipeline& pipeline) const;
  [[nodiscard]] std::string fault_of_samples();

  ifog::status_t before_, now_;
  SensorWatch watch_;
  // As of the last update().
  struct Samples {
    std::uint64_t decoded = 0, accepted = 0;
    std::uint32_t axes_seen = 0;
    bool news = false;                           // there were new ones
    int seconds = 0;                             // number of updates with new ones
    std::int64_t first_look_ns = 0;              // monotonic time of the first update
    std::int64_t last_ns = 0;                    // monotonic time of the last update with new ones
    bool mixed = false;                          // frames of two devices arrive, and none is used
    bool frozen = false, frozen_before = false;  // all samples repeat earlier ones
  } samples_;
  std::vector<std::string> axes_;
  double nominal_rate_hz_;
  CountedRate input_rate_, output_rate_;
  double interval_error_ = 0.0, interval_error_before_ = 0.0;
  int in_vain_ = 0;  // consecutive updates with received data but without any good frame
};

}  // namespace ifog

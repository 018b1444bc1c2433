// SPDX-License-Identifier: Apache-2.0
// The 1 Hz health message of one sensor, and the counters whose movement is worth a line in the log.
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

  // From the counters now and the last snapshot of the filter, with its books; interval_s since the call
  // before.
  const ifog::status_t& update(Pipeline& pipeline, const FilterSnapshot& snapshot, double interval_s);
  // Likewise of the flight recorder, before update().
  void update(Recorder& recorder);
  // Which fault counters moved with the last update(): "frames_crc +3, sequence_gaps +1"; "" for none.
  [[nodiscard]] std::string moved() const;

  // Once, some seconds after the first sample, when an axis has had no value in any; "" else.
  [[nodiscard]] std::string unseen_axes() const;

  // Once, when a device is found to repeat itself; "" else.
  [[nodiscard]] std::string newly_frozen() const;

  // Once, when a device with a counter and no clock sends at another rate than configured: by how much its
  // intervals, and the angle if it sends a rate, are wrong, in words; "" otherwise.
  [[nodiscard]] std::string wrong_rate() const;

  // What was noticed of the sensor with the last update() and was not before, in words; "" for nothing.
  [[nodiscard]] std::string newly_noticed() const;
  // Learns again what the sensor is like.
  void renew_watch() { watch_.renew(); }

  // A warning of the transport has been logged.
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
  [[nodiscard]] std::string came() const;  // in words

  ifog::status_t before_, now_;
  SensorWatch watch_;
  // As the last update() found them.
  struct Samples {
    std::uint64_t decoded = 0, accepted = 0;
    std::uint32_t axes_seen = 0;
    bool news = false;                           // there were new ones
    int seconds = 0;                             // updates that found new ones
    std::int64_t last_ns = 0;                    // monotonic: when the last update that found new ones was
    bool mixed = false;                          // frames of two devices arrive, and none is used
    bool frozen = false, frozen_before = false;  // samples come, and they are all those that came before
  } samples_;
  std::vector<std::string> axes_;
  double nominal_rate_hz_;
  CountedRate input_rate_, output_rate_;
  double interval_error_ = 0.0, interval_error_before_ = 0.0;
  int in_vain_ = 0;  // updates in a row after which something had come, and never a good frame
};

}  // namespace ifog

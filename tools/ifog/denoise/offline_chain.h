// SPDX-License-Identifier: Apache-2.0
// The daemon's signal chain over a recording: the same parts, fed from a file, so that each sample comes out
// with the bits the daemon publishes for the same frames and settings.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "drivers/capture/times/sample_times.h"
#include "filters/chain/incrementer.h"
#include "filters/chain/signal_chain.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/flight/flight_input.h"
#include "tools/ifog/captures/table/long_table.h"

namespace ifog::tools {

struct OfflineSettings {
  SensorConfig sensor;                  // model, filter, options, channels; its transport is not used
  std::shared_ptr<const Model> model;   // null: none
  std::optional<LearnedNoise> learned;  // ChainSettings::learned
  // Number of the first sample in the recording that this one is a part of; its own otherwise.
  std::optional<std::uint64_t> first_sequence;
  std::optional<double> since_power_up_s;  // ChainSettings::since_power_up_s
};

struct OfflineSink {
  // Once, before the first sample: the sensor's axes.
  std::function<void(const std::vector<std::string>& axes)> begin;
  // Before the first sample of a recording: what its times are counted from.
  std::function<void(const TimeOrigin&)> count_from;
  // One sample. time_s: as the capture or recording has it (sample_times.h), from its origin. Whether it
  // counts in the result: it is of the part that is wanted.
  std::function<bool(double time_s, const Increment&, const ChainOutput&)> sample;
};

// Hands a recording's samples on with the times that every command has for them. Of a device whose clock
// jumps back the daemon continues, and so does this.
class OfflineTimes {
 public:
  OfflineTimes(const ifog_description& description, const OfflineSink& sink);
  // Before what the chain makes of the sample is asked for.
  void come(const ifog_sample& sample);
  [[nodiscard]] double now_s() const { return now_s_; }
  [[nodiscard]] SampleTimes& times() { return times_; }

 private:
  SampleTimes times_;
  const OfflineSink& sink_;
  double now_s_ = 0.0;
  bool begun_ = false;
};

struct OfflineResult {
  std::vector<std::string> axes;
  IncrementerCounts counts;           // of what counts, see OfflineSink
  FilterSettings filter;              // in force at the end
  AxisShares shares;                  // ChainParts::shares()
  bool learns_walk = false;           // ChainParts::learns_walk()
  bool noise_learned = false;         // from the first seconds
  bool noise_known = true;            // false: no stretch of the record shows it
  std::vector<std::string> left_out;  // effects of the model that are not corrected
  std::string model;                  // identity
  double sample_rate_hz = 0.0;        // nominal
  // For a flight recording: something is missing there, or its run's beginning, and the filter of the daemon
  // may have stood otherwise.
  std::optional<double> not_as_published_from_s;
  // Samples that the daemon's filter had as one with others, so that these rows are more than it published,
  // and about where the first was.
  std::uint64_t merged = 0;
  std::optional<double> merged_from_s;
  std::size_t runs = 1;         // of the daemon, in a flight recording
  double between_runs_s = 0.0;  // not recorded
  std::size_t exchanges = 0;    // of model or filter settings within them
};

// All throw std::runtime_error or std::invalid_argument with one line.
// name: of the capture, for messages.
OfflineResult denoise_capture(const LongTable& capture, const std::string& name,
                              const OfflineSettings& settings, const OfflineSink& sink);
// The samples, times and channels that the daemon had.
// As it was recorded: settings are asked for at the first file, at each with which the daemon took others
// into use, and at each restart of the daemon. `fixed`: they are one for all of it, and only
// the restarts count.
OfflineResult denoise_flight(FlightInput& flight, DriverInstance& driver,
                             const std::function<OfflineSettings()>& settings, bool fixed,
                             const OfflineSink& sink);
OfflineResult denoise_recording(const CaptureInput& input, InputFile& file, DriverInstance& driver,
                                const OfflineSettings& settings, const OfflineSink& sink);

}  // namespace ifog::tools

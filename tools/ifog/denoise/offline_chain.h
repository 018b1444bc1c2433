// SPDX-License-Identifier: Apache-2.0
// Runs the daemon's signal chain over a recording. For the same frames and settings each output has the bits
// that the daemon publishes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "drivers/host/driver_instance.h"
#include "filters/chain/incrementer.h"
#include "filters/chain/signal_chain.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/flight/flight_input.h"

namespace ifog::tools {

class DenoisedRows;

struct OfflineSettings {
  SensorConfig sensor;                  // model, filter, options, channels; its transport is not used
  std::shared_ptr<const Model> model;   // null: none
  std::optional<LearnedNoise> learned;  // ChainSettings::learned
  // Number of the first sample if this is a part of a longer recording; otherwise the recording's own number.
  std::optional<std::uint64_t> first_sequence;
  std::optional<double> since_power_up_s;  // ChainSettings::since_power_up_s
};

struct OfflineResult {
  std::vector<std::string> axes;
  IncrementerCounts counts;             // of the samples in the wanted part
  std::optional<double> refused_clock;  // Incrementer::refused_clock()
  FilterSettings filter;                // in use at the end
  AxisShares shares;                    // ChainParts::shares()
  bool learns_walk = false;             // ChainParts::learns_walk()
  bool noise_learned = false;           // from the first seconds
  bool noise_known = true;              // false: no stretch of the record shows it
  std::vector<std::string> left_out;    // effects of the model that are not corrected
  std::string model;                    // identity
  double sample_rate_hz = 0.0;          // nominal
  // From here on the state of the daemon's filter may have been different, because samples or the beginning
  // of its run are missing.
  std::optional<double> not_as_published_from_s;
  // Samples that the daemon merged with others; so there are more rows than published messages. Also the time
  // of the first one.
  std::uint64_t merged = 0;
  std::optional<double> merged_from_s;
  std::size_t runs = 1;         // of the daemon, in a flight recording
  double between_runs_s = 0.0;  // not recorded
  std::size_t exchanges = 0;    // of model or filter settings within the runs
};

// All pass each output to `rows`, and throw std::runtime_error or std::invalid_argument with one line. name: of the capture, for messages.
OfflineResult denoise_capture(const CaptureView& capture, const std::string& name,
                              const OfflineSettings& settings, DenoisedRows& rows);
// Uses the samples, times and channels that the daemon had. Calls `settings` at the first file, at each file
// with other settings and at each restart of the daemon. `fixed`: the settings do not change, and only
// restarts count.
OfflineResult denoise_flight(FlightInput& flight, DriverInstance& driver,
                             const std::function<OfflineSettings()>& settings, bool fixed,
                             DenoisedRows& rows);
OfflineResult denoise_recording(const CaptureInput& input, InputFile& file, DriverInstance& driver,
                                const OfflineSettings& settings, DenoisedRows& rows);

// Settings for a driver's samples. path: of the recording, for messages. Throws std::runtime_error with one
// line if the sample rate is unknown.
[[nodiscard]] ChainSettings recording_settings(const OfflineSettings& settings, const DriverInstance& driver,
                                               const std::string& path);

class ChainRun {
 public:
  // Begins the rows. Throws std::runtime_error with one line; names the file if the model is wrong.
  ChainRun(const ChainSettings& settings, const OfflineSettings& offline, DenoisedRows& rows);
  // Starts as the daemon does.
  void begin(const ChainSettings& settings);
  // Uses other settings from the next sample on, as the daemon does.
  void exchange(const ChainSettings& settings);
  // Adds the output to the rows; only samples in their part count in the result. False: the sample is a
  // duplicate or out of order.
  bool run(const Reading& reading, double time_s);
  void discontinuity() { incrementer_->discontinuity(); }
  OfflineResult finish();

 private:
  void describe();
  // Says if the samples since the last call count in the result.
  void count(bool counts);

  std::string model_path_;
  DenoisedRows& rows_;
  std::optional<Incrementer> incrementer_;
  std::optional<SignalChain> chain_;
  Increment increment_;
  ChainOutput out_;
  std::optional<std::uint64_t> first_sequence_;
  std::uint64_t sequence_shift_ = 0;
  OfflineResult result_;
  IncrementerCounts counted_;  // of this incrementer, by count()
  bool counts_ = true;         // for the last sample
};

}  // namespace ifog::tools

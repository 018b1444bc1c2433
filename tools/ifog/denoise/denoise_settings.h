// SPDX-License-Identifier: Apache-2.0
// The options of `ifog denoise`, and the sensor and its settings that this makes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "drivers/capture/recording.h"
#include "filters/settings/filter_settings.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/flight/flight_input.h"
#include "tools/ifog/captures/time_part.h"
#include "tools/ifog/denoise/offline_chain.h"

namespace ifog::tools {

struct DenoiseOptions {
  std::string capture, output, model, config, sensor, json, picture, noise;
  double nominal_rate_hz = 0.0, start_up_s = 0.0;
  std::optional<std::uint64_t> first_sequence;
  std::optional<double> since_power_up_s;
  TimePart part;
  CaptureInput input;
  FilterChoice filter;
  bool smooth = false;

  // Something is said here that stands over what a recording was made with.
  [[nodiscard]] bool over_the_recording() const;
};

// The sensor of --config; empty without.
struct ConfiguredSensor {
  SensorConfig sensor;
  std::vector<std::string> plugin_folders;
};

// The sensor of --config that is meant. Its files enter the table of the run's (command_files.h), and where
// the capture goes through a driver and none other is named, `options` has its driver from here on, whose
// options stand behind those of the command line; each option's path begins where that option was said.
// Throws std::runtime_error or ConfigError.
[[nodiscard]] std::optional<ConfiguredSensor> configured_sensor(DenoiseOptions& options, FileKind kind);

// flight: null for other captures; its settings are those of the file it is in. What the command line says
// stands over the configuration, and that over the recording.
[[nodiscard]] OfflineSettings settings_of(const DenoiseOptions& options,
                                          const std::optional<ConfiguredSensor>& configured,
                                          const FlightInput* flight);

}  // namespace ifog::tools

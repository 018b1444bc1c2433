// SPDX-License-Identifier: Apache-2.0
// The options of `ifog denoise`, and the sensor and settings that they define.
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

  // True if an option overrides the settings of a recording.
  [[nodiscard]] bool overrides_recording() const;
};

// The sensor of --config.
struct ConfiguredSensor {
  SensorConfig sensor;
  std::vector<std::string> plugin_folders;
};

// Selects the sensor of --config and registers its files as inputs of the run (command_files.h). If the
// capture needs a driver and none is given, `options` gets the sensor's driver, with its options after those
// of the command line. Relative paths start at the folder of the configuration or the working folder. Throws
// std::runtime_error or ConfigError.
[[nodiscard]] std::optional<ConfiguredSensor> configured_sensor(DenoiseOptions& options, FileKind kind);

// flight: null for other captures; its settings are those of the present file. The command line overrides the
// configuration, and that the recording.
[[nodiscard]] OfflineSettings settings_of(const DenoiseOptions& options,
                                          const std::optional<ConfiguredSensor>& configured,
                                          const FlightInput* flight);

}  // namespace ifog::tools

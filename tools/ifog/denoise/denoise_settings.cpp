// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/denoise_settings.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "daemon/sensor/sensor_parts.h"
#include "daemon/state/state_folder.h"
#include "drivers/ifog/quoted.h"
#include "filters/model_file/kept_noise.h"
#include "filters/settings/filter_table.h"
#include "tools/ifog/captures/configured_files.h"
#include "tools/ifog/console/command_files.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/field/field.h"

namespace ifog::tools {
namespace {

const SensorConfig& chosen(const Config& config, const DenoiseOptions& options) {
  const auto found =
      std::find_if(config.sensors.begin(), config.sensors.end(), [&](const SensorConfig& sensor) {
        return options.sensor.empty() ? config.sensors.size() == 1 : sensor.name == options.sensor;
      });
  if (found != config.sensors.end()) return *found;
  throw refusal("{}: {}", options.config,
                options.sensor.empty() ? "has several sensors; expected --sensor NAME"
                                       : "has no sensor \"" + printable(options.sensor) + "\"");
}

void take_driver(const ConfiguredSensor& from, CaptureInput& input) {
  const SensorConfig& sensor = from.sensor;
  if (input.has_driver() && input.driver_name() != sensor.driver) return;
  input.driver = sensor.driver;
  const std::shared_ptr<const Plugin> plugin =
      find_plugin(sensor.driver, plugin_folders(from.plugin_folders));
  const DriverSettings said = input.settings();
  for (const auto& [key, value] : with_files_in(sensor.folder, plugin->table(), sensor.options))
    if (!said.contains(key)) input.options.push_back(key + "=" + value);
}

bool says_anything(const FilterChoice& choice) {
  const auto& table = filter_table();
  return std::any_of(table.begin(), table.end(), [&](const FilterSetting& setting) {
    return std::visit([&](const auto& member) { return (choice.*member.choice).has_value(); },
                      setting.member);
  });
}

}  // namespace

bool DenoiseOptions::overrides_recording() const {
  return says_anything(filter) || !model.empty() || !noise.empty() || nominal_rate_hz > 0.0 ||
         start_up_s > 0.0 || since_power_up_s || first_sequence || input.has_driver() ||
         !input.options.empty();
}

std::optional<ConfiguredSensor> configured_sensor(DenoiseOptions& options, FileKind kind) {
  if (options.config.empty()) return std::nullopt;
  Config config = read_config(options.config);
  // systemd gives the service its state folder; on a terminal there may be none.
  if (std::error_code none; state_folder(config.state_folder).empty() &&
                            std::filesystem::equivalent(options.config, kServiceConfig, none))
    use_adopted_models(config, kServiceState);
  will_read_files_of(config);
  ConfiguredSensor out{chosen(config, options), config.plugin_folders};
  if (kind == FileKind::bytes || kind == FileKind::candump || kind == FileKind::flight)
    take_driver(out, options.input);
  return out;
}

OfflineSettings settings_of(const DenoiseOptions& options, const std::optional<ConfiguredSensor>& configured,
                            const FlightInput* flight) {
  OfflineSettings out;
  if (configured)
    out.sensor = configured->sensor;
  else if (flight != nullptr)
    out.sensor = flight->sensor();
  const bool as_recorded = flight != nullptr && !configured;
  out.sensor.filter = over(options.filter, std::move(out.sensor.filter));
  if (!options.model.empty()) out.sensor.model_adopted = false, out.sensor.model = options.model;
  if (options.nominal_rate_hz > 0.0) out.sensor.nominal_rate_hz = options.nominal_rate_hz;
  if (options.start_up_s > 0.0) out.sensor.start_up_s = options.start_up_s;
  out.model =
      as_recorded && options.model.empty() ? flight->model(out.sensor) : read_sensor_model(out.sensor);
  out.first_sequence = options.first_sequence;
  out.since_power_up_s = options.since_power_up_s;
  if (!options.noise.empty())
    out.learned = read_kept_noise(options.noise).noise;
  else if (as_recorded)
    out.learned = flight->noise(out.sensor);
  return out;
}

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
// Housekeeping::reload(): rereads the configuration and exchanges parts between two samples.
#include <algorithm>
#include <exception>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/housekeeping/housekeeping.h"
#include "daemon/sensor/flight_header.h"
#include "daemon/sensor/sensor_parts.h"
#include "drivers/ifog/quoted.h"
#include "drivers/transport/clock.h"
#include "filters/model_file/model_axes.h"

namespace ifog {
namespace {

// Null if there is none of that name.
const SensorConfig* sensor_named(const Config& config, const std::string& name) {
  const auto found =
      std::ranges::find_if(config.sensors, [&](const SensorConfig& sensor) { return sensor.name == name; });
  return found == config.sensors.end() ? nullptr : &*found;
}

}  // namespace

void Housekeeping::say_what_needs_a_restart(const Config& fresh) {
  if (const std::string keys = config_.restart_for(fresh); !keys.empty())
    log_->warn("changed in [daemon], needs a restart: {}", keys);
  for (const SensorConfig& sensor : fresh.sensors)
    if (sensor_named(config_, sensor.name) == nullptr)
      log_->warn("sensor \"{}\" is new in {}, needs a restart", printable(sensor.name), config_.file);
  for (const auto& sensor : sensors_) {
    const SensorConfig* const other = sensor_named(fresh, sensor->config.name);
    if (other == nullptr) {
      sensor->log->warn("no longer in {}: runs until a restart", config_.file);
    } else if (const std::string keys = sensor->config.restart_for(*other); !keys.empty()) {
      sensor->log->warn("changed, needs a restart: {}", keys);
    }
  }
}

// Builds everything for a sensor from the new configuration, before any of it is used. Throws
// std::runtime_error with one line.
Housekeeping::Renewed Housekeeping::renew(Sensor& sensor, const SensorConfig& fresh) {
  // Also what only a restart will use.
  (void)make_sensor_driver(fresh, config_.plugin_folders);
  // Only what can change between two samples.
  Renewed out{.sensor = &sensor, .config = sensor.config.reloaded(fresh)};
  const std::shared_ptr<const Model> model = read_sensor_model(out.config);
  ChainSettings settings =
      sensor_chain_settings(out.config, sensor.parts.pipeline->reader().driver().description(), model);
  out.choice = chain_choice(out.config, model.get());
  // An unchanged sensor continues with its filter, its learned noise and rate.
  if (out.choice == sensor.parts.choice) return out;
  settings.learned = sensor.snapshot.learned ? sensor.snapshot.learned : sensor.parts.noise.recalled();
  settings.powered_ns = powered_ns(out.config);
  out.parts = make_chain_parts(out.config, settings);
  if (model != nullptr) out.remarks = remarks_on_axes(*model, settings.axes);
  out.noise = sensor.parts.noise.text(settings.learned);
  return out;
}

void Housekeeping::use(Renewed renewed) {
  Sensor& sensor = *renewed.sensor;
  sensor.config = std::move(renewed.config);
  if (renewed.parts == nullptr) {
    sensor.log->info("reloaded: nothing changed, the filter continues");
    return;
  }
  for (const std::string& remark : renewed.remarks) sensor.log->warn("{}: {}", sensor.config.model, remark);
  for (const std::string& effect : renewed.parts->left_out()) sensor.log->warn("not corrected: {}", effect);
  sensor.log->info("reloaded: model {}, filter settings",
                   sensor.config.model.empty() ? "none" : sensor.config.model);
  sensor.parts.choice = std::move(renewed.choice);
  const std::uint32_t number = ++sensor.settings;
  // Before the filter can have the parts, because the recorder needs the header for their note.
  if (sensor.parts.recorder != nullptr)
    sensor.parts.recorder->set_header(
        flight_header(sensor.config, config_, sensor.parts.pipeline->reader().driver(), renewed.noise),
        number);
  sensor.parts.pipeline->filter().offer(std::move(renewed.parts), number);
  // The usual behaviour of the sensor may change.
  sensor.report.renew_watch();
}

std::string Housekeeping::reload() {
  notify("RELOADING=1\nMONOTONIC_USEC=" + std::to_string(monotonic_ns() / 1000));
  std::vector<Renewed> renewed;
  std::vector<std::string> errors;
  Config fresh;
  try {
    fresh = read_config(config_.file);
  } catch (const std::exception& error) {
    errors.emplace_back(error.what());
  }
  for (const auto& sensor : sensors_) {
    const SensorConfig* const found = sensor_named(fresh, sensor->config.name);
    if (found == nullptr) continue;
    try {
      renewed.push_back(renew(*sensor, *found));
    } catch (const std::exception& error) {
      errors.push_back(error_at(fresh, *found, error));
    }
  }
  std::string refused;
  for (const std::string& error : errors) {
    log_->error("{}", error);
    refused += (refused.empty() ? "" : "\n") + error;
  }
  if (errors.empty()) {
    say_what_needs_a_restart(fresh);
    for (Renewed& each : renewed) use(std::move(each));
  } else {
    log_->error("reload refused: nothing has changed for any sensor");
  }
  notify("READY=1");
  return refused;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// From a sensor's configuration to its driver, transport and signal chain: no threads, no LCM. The command
// line goes the same way, so that it filters as the daemon does.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "daemon/sensor/facts.h"
#include "drivers/host/driver_instance.h"
#include "drivers/transport/transport.h"
#include "filters/chain/signal_chain.h"
#include "filters/model_file/model.h"

namespace ifog {

// All throw KeyError with one line; transports std::runtime_error, too.

DriverInstance make_sensor_driver(const SensorConfig& sensor, const std::vector<std::string>& plugin_folders);

// The line as configured; its speed from the driver where the configuration has none.
SerialSettings sensor_serial_settings(const SensorConfig& sensor, const DriverInstance& driver);

std::unique_ptr<Transport> make_sensor_transport(const SensorConfig& sensor, const DriverInstance& driver);

// Channels: those of the driver's frames first, then the configured ones that come from elsewhere. Null
// model: none.
ChainSettings sensor_chain_settings(const SensorConfig& sensor, const ifog_description& description,
                                    std::shared_ptr<const Model> model);

// What a reload can change of a sensor's chain: of equal ones the parts would be equal, too.
struct ChainChoice {
  FilterChoice filter;
  double start_up_s = 0.0;
  std::string model;  // its text, "" for none

  bool operator==(const ChainChoice& other) const;
};
ChainChoice chain_choice(const SensorConfig& sensor, const Model* model);

// When a sensor was switched on, arrival clock. Known only where it is switched on with the computer,
// suspended time since then included; nullopt otherwise.
std::optional<std::int64_t> powered_ns(const SensorConfig& sensor);

// Identifies the computer's run since it was switched on, as the service manager hands it on (IFOGD_BOOT_ID) or the
// kernel has it, which a confined service does not see; "" where neither says.
std::string boot_id();

// Null when the sensor has none.
std::shared_ptr<const Model> read_sensor_model(const SensorConfig& sensor);

// What the settings make; `sensor` says where a complaint belongs.
std::unique_ptr<ChainParts> make_chain_parts(const SensorConfig& sensor, const ChainSettings& settings);

// Channels that do not come in the sensor's frames, in the order of the chain's.
std::vector<ChannelConfig> outside_channels(const SensorConfig& sensor);

}  // namespace ifog

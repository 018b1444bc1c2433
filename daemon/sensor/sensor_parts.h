// SPDX-License-Identifier: Apache-2.0
// Builds driver, transport and signal chain from a sensor's configuration: no threads, no LCM. Also used by
// the command line, so that it filters like the daemon.
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

// All throw KeyError with one line; transports also std::runtime_error.

DriverInstance make_sensor_driver(const SensorConfig& sensor, const std::vector<std::string>& plugin_folders);

// Serial line as configured; the speed is the driver's if not configured.
SerialSettings sensor_serial_settings(const SensorConfig& sensor, const DriverInstance& driver);

std::unique_ptr<Transport> make_sensor_transport(const SensorConfig& sensor, const DriverInstance& driver);

// Channels: first those of the driver's frames, then the external ones. model: may be null.
ChainSettings sensor_chain_settings(const SensorConfig& sensor, const ifog_description& description,
                                    std::shared_ptr<const Model> model);

// Parts of a sensor's chain that a reload can change; equal choices give equal parts.
struct ChainChoice {
  FilterChoice filter;
  double start_up_s = 0.0;
  std::string model;  // its text, or ""

  bool operator==(const ChainChoice& other) const;
};
ChainChoice chain_choice(const SensorConfig& sensor, const Model* model);

// Arrival clock at power-up of the sensor. Known only if it is powered with the computer, including suspended
// time; else nullopt.
std::optional<std::int64_t> powered_ns(const SensorConfig& sensor);

// Boot id of the computer, from the service manager (IFOGD_BOOT_ID) or the kernel (hidden from confined
// services); "" if unknown.
std::string boot_id();

// Null if the sensor has none.
std::shared_ptr<const Model> read_sensor_model(const SensorConfig& sensor);

// Builds the parts; `sensor` gives the place of an error.
std::unique_ptr<ChainParts> make_chain_parts(const SensorConfig& sensor, const ChainSettings& settings);

// External channels, in the order of the chain's.
std::vector<ChannelConfig> outside_channels(const SensorConfig& sensor);

}  // namespace ifog

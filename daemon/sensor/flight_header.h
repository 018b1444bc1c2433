// SPDX-License-Identifier: Apache-2.0
// Header of a sensor's flight recordings, and the inverse.
#pragma once

#include <string>

#include "daemon/config/config.h"
#include "drivers/flight/header.h"
#include "drivers/host/driver_instance.h"

namespace ifog {

// Includes the model and the files named in driver options, so that another computer can read the recording.
// Files that cannot be read, or exceed kInputLimits.carried_bytes together, are missing, and readers must
// name them. noise: text of the file of initial noise, or "".
FlightHeader flight_header(const SensorConfig& sensor, const Config& config, const DriverInstance& driver,
                           const std::string& noise);

// The sensor as configured; without a configuration in the header, from name, driver and options. Throws
// std::runtime_error with one line for what this version does not understand.
SensorConfig recorded_sensor(const FlightHeader& header);

// "/dev/ttyUSB0", "can0", "udp port 4000", or a path.
std::string source_of(const TransportConfig& transport);

}  // namespace ifog

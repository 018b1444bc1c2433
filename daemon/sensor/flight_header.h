// SPDX-License-Identifier: Apache-2.0
// What a sensor's flight recordings say of it in their header, and back.
#pragma once

#include <string>

#include "daemon/config/config.h"
#include "drivers/flight/header.h"
#include "drivers/host/driver_instance.h"

namespace ifog {

// With the text of the model and of the files that the driver's options name, so that another computer reads the recording as
// this one would. Files that cannot be read now or are larger than kInputLimits.carried_bytes together are missing, and who
// reads the recording has to name them. `noise`: what the filter begins with, as the file of it; "" for none.
FlightHeader flight_header(const SensorConfig& sensor, const Config& config, const DriverInstance& driver,
                           const std::string& noise);

// The sensor as it was configured; where the header carries no configuration, by name, driver and options.
// Throws std::runtime_error with one line: what this version does not understand of it.
SensorConfig recorded_sensor(const FlightHeader& header);

// "/dev/ttyUSB0", "can0", "udp port 4000", a path.
std::string source_of(const TransportConfig& transport);

}  // namespace ifog

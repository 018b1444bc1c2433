// SPDX-License-Identifier: Apache-2.0
// The settings of a chain behind a driver.
#pragma once

#include "daemon/sensor/sensor_parts.h"

namespace ifog {

// As the daemon sets it up for that driver, with the noise given.
inline ChainSettings chain_behind(const DriverInstance& driver, double rate_hz, double process_noise = 1e-10,
                                  double measurement_noise = 1e-8) {
  SensorConfig sensor;
  sensor.nominal_rate_hz = rate_hz;
  sensor.filter.process_noise = process_noise;
  sensor.filter.measurement_noise = measurement_noise;
  return sensor_chain_settings(sensor, driver.description(), nullptr);
}

}  // namespace ifog

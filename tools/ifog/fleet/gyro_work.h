// SPDX-License-Identifier: Apache-2.0
// What is done for one gyro of a fleet, by a process of its own: its diagnosis, as `ifog diagnose` makes it,
// and the measurement of its type's effects.
#pragma once

#include <string>

#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/time_part.h"
#include "tools/ifog/diagnose/sensor_diagnosis.h"
#include "tools/ifog/fleet/results.h"

namespace ifog::tools {

struct FleetSettings {
  CaptureInput input;
  TimePart part;
  AxesToDiagnose wanted;

  // All of the above that changes a result, and the program's version, as text.
  [[nodiscard]] std::string text() const;
};

// Whether the results hold what these captures and options come to. A failure is none: it is tried again.
bool is_diagnosed(const Results& results, const FleetGyro& gyro, const std::string& options);
bool is_measured(const Results& results, const FleetGyro& gyro, const std::string& options,
                 const TypeToMeasure& type);

// Does what is missing: the diagnosis, and where the type's effects are written, their measurement. What is
// wrong with the captures is written into the results and thrown, std::runtime_error with one line.
void work_on(const Results& results, const FleetGyro& gyro, const FleetSettings& settings);

}  // namespace ifog::tools

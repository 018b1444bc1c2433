// SPDX-License-Identifier: Apache-2.0
// Work of the process of one gyro: its diagnosis, as `ifog diagnose` makes it, and the measurement of its
// type's effects.
#pragma once

#include <string>

#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/diagnose/sensor_diagnosis.h"
#include "tools/ifog/fleet/results.h"

namespace ifog::tools {

struct FleetSettings {
  CaptureInput input;
  TimePart part;
  AxesToDiagnose wanted;

  // All settings that change a result, and the program's version, as text.
  [[nodiscard]] std::string text() const;
};

// True if there is a result of these captures and options. A failure does not count and is tried again.
bool is_diagnosed(const Results& results, const FleetGyro& gyro, const std::string& options);
bool is_measured(const Results& results, const FleetGyro& gyro, const std::string& options,
                 const TypeToMeasure& type);

// Does what is missing: the diagnosis, and the measurement if the type's effects are known. Errors in the
// captures are written into the results and thrown as std::runtime_error with one line.
void work_on(const Results& results, const FleetGyro& gyro, const FleetSettings& settings);

}  // namespace ifog::tools

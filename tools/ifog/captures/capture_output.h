// SPDX-License-Identifier: Apache-2.0
// A capture as the recording that a device would have left, by its driver's encoder.
#pragma once

#include <string>

#include "tools/ifog/captures/capture_input.h"

namespace ifog::tools {

// `to` ends in .log for a CAN driver, in .bin or .kvh for one that speaks bytes. `name` is what messages call
// the capture. What the format has no place for is told on standard error. Throws std::runtime_error with one
// line, or CLI::ValidationError (usage) when driver and ending do not fit.
void write_recording(const Capture& capture, const std::string& name, const std::string& to,
                     const CaptureInput& encoding, const std::string& axis);

}  // namespace ifog::tools

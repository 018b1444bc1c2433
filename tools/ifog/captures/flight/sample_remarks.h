// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace ifog {
class CaptureBuilder;
}  // namespace ifog

namespace ifog::tools {

// To standard error, one line for each counter of a driver's samples that moved: missing, repeated, of two devices, invalid.
void say_of_samples(const CaptureBuilder& builder, const std::string& path);

}  // namespace ifog::tools

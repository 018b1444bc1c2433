// SPDX-License-Identifier: Apache-2.0
// What this computer's own files say of a sensor that is heard: its messages carry neither driver nor transport, and of the
// model an identity.
#pragma once

#include <set>
#include <string>

namespace ifog::tools {

struct KnownSensor {
  std::string driver;           // "kvh1750, serial /dev/ttyUSB0"
  std::string model, identity;  // "nose.toml of 2026-11-27 01:30", and that model's identity; "" without one
  std::string proposal;         // that waits, in one line; "" for none
  std::set<std::string> channels;  // configured besides those of its own frames
};

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
// A sensor as lines of text, for a screen of any width or a file.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tools/ifog/console/say.h"
#include "tools/ifog/monitor/sensor_view.h"

namespace ifog::tools {

enum class RateUnit {
  automatic,  // °/h below 0.1 °/s, °/s above
  degree_per_hour,
  degree_per_second,
  radian_per_second,
};

struct LineStyle {
  std::size_t width = 0;  // columns; 0: unlimited
  bool details = true;    // latency, balances, channels
  RateUnit unit = RateUnit::automatic;
};

// Information in this computer's files about a sensor on LCM. Its messages contain neither driver nor
// transport, and only the model's identity.
struct KnownSensor {
  std::string driver;  // "kvh1750, serial /dev/ttyUSB0"
  // "nose.toml of 2026-11-27 01:30", and that model's identity; "" without a model
  std::string model, identity;
  std::string proposal;            // one line; "" without a proposal
  std::set<std::string> channels;  // configured in addition to those in its frames
};

const char* tone_name(Tone tone);

// State of the sensor as a colour.
Tone tone_of(const SensorView& sensor);

// Control characters in names from the network are removed. `known`: null if nothing is known.
std::vector<ShownLine> view_lines(std::string_view name, const SensorView& sensor, const LineStyle& style,
                                  const KnownSensor* known = nullptr);

// Joins parts into as many lines as necessary; lines after the first are indented by four.
std::vector<std::string> wrapped(const std::vector<std::string>& parts, std::string_view separator,
                                 std::size_t width);

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
// A sensor as lines of text, for a screen of any width and for a file.
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
  std::size_t width = 0;  // columns; 0: as wide as it takes
  bool details = true;    // latency, books, channels
  RateUnit unit = RateUnit::automatic;
};

// What this computer's own files say of a sensor on LCM: its messages carry neither driver nor transport, and of the model
// an identity.
struct KnownSensor {
  std::string driver;           // "kvh1750, serial /dev/ttyUSB0"
  std::string model, identity;  // "nose.toml of 2026-11-27 01:30", and that model's identity; "" without one
  std::string proposal;         // that waits, in one line; "" for none
  std::set<std::string> channels;  // configured besides those of its own frames
};

const char* tone_name(Tone tone);

// How the sensor does, in a word.
Tone tone_of(const SensorView& sensor);

// Names from the network are unchanged in them, but without control characters. `known`: null for nothing.
std::vector<ShownLine> view_lines(std::string_view name, const SensorView& sensor, const LineStyle& style,
                                  const KnownSensor* known = nullptr);

// Words one behind the other, in as many lines as it takes; the second and later ones are indented by four.
std::vector<std::string> wrapped(const std::vector<std::string>& parts, std::string_view separator,
                                 std::size_t width);

}  // namespace ifog::tools

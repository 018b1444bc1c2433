// SPDX-License-Identifier: Apache-2.0
// A sensor as lines of text, for a screen of any width and for a file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

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

// Names from the network in them are as they came, but without control characters.
std::vector<std::string> view_lines(std::string_view name, const SensorView& sensor, const LineStyle& style);

// Columns that a text takes on a terminal: bytes that begin a character.
std::size_t columns_of(std::string_view text);

// Words one behind the other, in as many lines as it takes; the second and later ones are indented by four.
std::vector<std::string> wrapped(const std::vector<std::string>& parts, std::string_view separator,
                                 std::size_t width);

}  // namespace ifog::tools

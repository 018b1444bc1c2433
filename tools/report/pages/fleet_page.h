// SPDX-License-Identifier: Apache-2.0
// The page of a type of gyro: its effects, the spread of its parameters, outliers. One HTML file in the style
// of the diagnosis page; the gyros' own pages are in gyros/SERIAL/report.html.
#pragma once

#include <string>

#include "filters/population/population.h"

namespace ifog::report {

struct FleetPage {
  const Population* population = nullptr;
  std::string made;     // date and program version
  std::string command;  // as typed
};

std::string fleet_page(const FleetPage& page);

// One of the type's effects as a sentence without full stop.
std::string in_words(const TypeEffect& effect);

}  // namespace ifog::report

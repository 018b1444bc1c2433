// SPDX-License-Identifier: Apache-2.0
// The page of a type of gyro: its effects, how its parameters are spread, which gyros stand out. One HTML
// file in the style of the diagnosis' page; the gyros' own pages lie next to it in gyros/SERIAL/report.html.
#pragma once

#include <string>

#include "filters/population/population.h"

namespace ifog::report {

struct FleetPage {
  const Population* population = nullptr;
  std::string made;     // date and program version
  std::string command;  // as it was typed
};

std::string fleet_page(const FleetPage& page);

// One of the type's effects in a sentence without its full stop, for a page and a terminal.
std::string in_words(const TypeEffect& effect);

}  // namespace ifog::report

// SPDX-License-Identifier: Apache-2.0
// Signals of a DBC file that make up the sensor: the driver's options, resolved.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/dbc/database.h"
#include "drivers/units/units.h"
#include "ifog/driver.h"
#include "ifog/options.h"

namespace ifog::dbc {

// Pointers into Picks::database, which does not change.
using Pick = SignalInMessage;

struct Axis {
  std::string name;  // "x", "y", "z", or "" for the single axis of `signal`
  Pick pick;
  double si_per_unit = 1.0;      // rad or rad/s per physical unit
  const Signal* sign = nullptr;  // bit of the same message that makes it negative; nullptr: none
};

struct Environment {
  std::string column;  // as in a capture: "temperature_degC"
  Pick pick;
  UnitConversion to_column;
};

// What a signal is to the sensor.
enum class Role : std::uint8_t { kAxis, kCounter, kStatus, kTime, kEnvironment };

struct Picks {
  Picks() = default;
  Picks(const Picks&) = delete;
  Picks& operator=(const Picks&) = delete;

  Database database;
  ifog_kind kind = IFOG_RATE;
  std::vector<Axis> axes;
  double angle_wrap_rad = 0.0;
  std::vector<Pick> counter;  // the same counter in each message that has it; empty: none
  std::uint32_t counter_modulus = 0;
  std::optional<Pick> status;
  std::uint32_t status_mask = 0xFFFFFFFFU;
  std::optional<std::uint32_t> status_good;  // valid if (status & mask) equals this; nullopt: always
  std::optional<Pick> time;
  double seconds_per_unit = 1.0;  // of `time`
  std::vector<Environment> environments;
  double rate_hz = 0.0;
  std::vector<std::string> remarks;  // for the user, a line each

  // Calls use(role, index, pick) for each; index: of the axis or environment channel.
  template <typename Use>
  void each(Use&& use) const {
    for (std::size_t i = 0; i < axes.size(); ++i) use(Role::kAxis, i, axes[i].pick);
    for (const Pick& one : counter) use(Role::kCounter, std::size_t{0}, one);
    if (status) use(Role::kStatus, std::size_t{0}, *status);
    if (time) use(Role::kTime, std::size_t{0}, *time);
    for (std::size_t i = 0; i < environments.size(); ++i) use(Role::kEnvironment, i, environments[i].pick);
  }
};

// Fills `out`. Throws std::exception with one line: errors of the DBC file with file and line; of an option
// with key, value and what was expected.
void read_picks(const plugin::Options& options, Picks& out);

// The driver's option list, terminated by an entry without key.
const ifog_option* option_list();

}  // namespace ifog::dbc

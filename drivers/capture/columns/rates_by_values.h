// SPDX-License-Identifier: Apache-2.0
// What the first values of a column tell of it, where its name does not: gravity, counts, an angle, and which
// of the columns without names are a sensor's axes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "drivers/capture/columns/column_roles.h"
#include "drivers/capture/columns/column_times.h"

namespace ifog {

// A column that may be a rate.
struct RateCandidate {
  std::size_t place = 0;
  std::string unit;  // "" where it is unknown
  std::string axis;
  double scale = 1.0;  // of counts
  bool reference = false, increment = false;
};

using Rates = std::vector<RateCandidate>;

// Three columns as long together as gravity are an accelerometer at rest: in m/s², g, mg or, of 16 bits and a
// range of 2, 4, 8 or 16 g, counts.
bool is_gravity(const TableSample& table, const Rates& columns);

// Whole numbers, as a converter counts.
bool are_counts(const TableSample& table, const Rates& rates);

// What a rate's column may hold where neither its name nor a row of units tells; the likeliest first.
std::vector<std::string> units_of(const TableSample& table, const Rates& rates);

// Columns that have no names, without those of the time: one of numbers is the rate, and three next to each
// other may be its axes.
std::vector<Rates> rates_by_place(const TableSample& table, const std::optional<CsvTime>& time);

}  // namespace ifog

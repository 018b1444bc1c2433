// SPDX-License-Identifier: Apache-2.0
// One capture of the sensor, as a diagnosis takes it.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "filters/allan/stretches.h"

namespace ifog {

// The caller keeps the arrays alive; all are as long as time_s.
struct RecordChannel {
  std::string name;                // the capture's column, NAME_UNIT
  std::span<const double> values;  // NaN: missing, held
  double period = 0.0;             // of an unwrapped angle, in its unit; 0: not an angle
};

// What a record's times are counted from, where they are large numbers: the sum of the two.
struct RecordOrigin {
  double whole_s = 0.0, beyond_s = 0.0;

  // A time of the record as its capture says it, and back.
  [[nodiscard]] double told(double time_s) const { return whole_s + (beyond_s + time_s); }
  [[nodiscard]] double since(double told_s) const { return told_s - whole_s - beyond_s; }
};

struct Record {
  std::string name;
  std::span<const double> time_s;             // strictly increasing
  std::span<const double> rate_radps;         // NaN: missing
  std::span<const double> reference_radps{};  // empty: none; then the true rate is assumed constant
  std::string reference_name = "reference_rate_radps";
  std::vector<RecordChannel> channels;
  // Rates of the same sensor, by the names of their columns: it rests when all of them do.
  std::vector<RecordChannel> other_axes;
  std::vector<std::span<const double>> other_references{};  // of those, in their order; empty: none
  std::vector<Stretch> at_rest;                             // samples, in order; empty: not looked for, all
  RecordOrigin origin;                                      // that time_s is counted from
};

// Values of the channel of that name; empty if the record has none.
inline std::span<const double> values_of(const Record& record, std::string_view name) {
  for (const RecordChannel& channel : record.channels) {
    if (channel.name == name) return channel.values;
  }
  return {};
}

// Whether there are two values.
inline bool moves(std::span<const double> values) {
  const auto finite = [](double value) { return std::isfinite(value); };
  const auto first = std::find_if(values.begin(), values.end(), finite);
  return std::any_of(first, values.end(), [&](double value) { return finite(value) && value != *first; });
}

}  // namespace ifog

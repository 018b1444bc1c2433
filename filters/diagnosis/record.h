// SPDX-License-Identifier: Apache-2.0
// One capture of the sensor as input of a diagnosis.
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
  std::string name;                // column of the capture, NAME_UNIT
  std::span<const double> values;  // NaN: missing, the last value holds
  double period = 0.0;             // period of an unwrapped angle, in its unit; 0: not an angle
};

// Origin of a record's times if they are large numbers: the sum of both parts.
struct RecordOrigin {
  double whole_s = 0.0, beyond_s = 0.0;

  // Converts between the record's time and the time in the capture.
  [[nodiscard]] double in_s(double time_s) const { return whole_s + (beyond_s + time_s); }
  [[nodiscard]] double since(double shown_s) const { return shown_s - whole_s - beyond_s; }
};

struct Record {
  std::string name;
  std::span<const double> time_s;             // strictly increasing
  std::span<const double> rate_radps;         // NaN: missing
  std::span<const double> reference_radps{};  // empty: the true rate is assumed constant
  std::string reference_name = "reference_rate_radps";
  std::vector<RecordChannel> channels;
  // Rates of the sensor's other axes, by column name. The sensor rests when all axes do.
  std::vector<RecordChannel> other_axes;
  std::vector<std::span<const double>> other_references{};  // of other_axes, in their order; empty: none
  std::vector<Stretch> at_rest;   // in samples, in order; empty: not determined, all
  RecordOrigin origin;            // of time_s
  double since_power_up_s = 0.0;  // at the first sample; 0 if not known: the record is taken to begin there

  // Rate minus reference, if there is one; NaN: missing.
  [[nodiscard]] double error(std::size_t i) const {
    return reference_radps.empty() ? rate_radps[i] : rate_radps[i] - reference_radps[i];
  }
};

// Values of a channel by name; empty if the record has none.
inline std::span<const double> values_of(const Record& record, std::string_view name) {
  for (const RecordChannel& channel : record.channels) {
    if (channel.name == name) return channel.values;
  }
  return {};
}

// True if the values are not all equal.
inline bool moves(std::span<const double> values) {
  const auto finite = [](double value) { return std::isfinite(value); };
  const auto first = std::ranges::find_if(values, finite);
  return std::any_of(first, values.end(), [&](double value) { return finite(value) && value != *first; });
}

}  // namespace ifog

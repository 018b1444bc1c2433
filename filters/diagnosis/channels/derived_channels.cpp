// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/channels/derived_channels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "filters/effects/meaning.h"
#include "filters/model_file/channel_names.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::size_t kMostDifferences = 6;
constexpr double kWholeTurn = 0.9;    // of the period: size of a wrap, and extent of the values
constexpr double kInsideTurn = 0.95;  // share of the values within the turn
constexpr double kRounding = 1e-3;    // of the period, beyond its ends
constexpr double kUnsure = 0.01;      // largest share of steps whose direction is ambiguous

struct Turn {
  double low = 0.0, high = 0.0;
  [[nodiscard]] bool has(double value) const { return value >= low && value <= high; }
};

// Turn from zero or from minus half a turn, whichever contains nearly all values; the others are faults of
// the logger.
std::optional<Turn> turn_of(std::span<const double> values, double period) {
  for (const double start : {0.0, -0.5 * period}) {
    const Turn turn{start - kRounding * period, start + (1.0 + kRounding) * period};
    const auto finite = std::ranges::count_if(values, [](double v) { return std::isfinite(v); });
    const auto inside = std::ranges::count_if(values, [&](double v) { return turn.has(v); });
    if (static_cast<double>(inside) >= kInsideTurn * static_cast<double>(finite)) return turn;
  }
  return std::nullopt;
}

template <class Name>
bool all_have(const std::vector<Record>& records, const Name& name) {
  return std::ranges::all_of(records, [&](const Record& record) { return moves(values_of(record, name)); });
}

// True if both measure the same quantity at different places.
bool alike(const std::string& one, const std::string& other) {
  const ChannelKind kind = kind_of(one);
  const bool has_gradients = kind == ChannelKind::kTemperature || kind == ChannelKind::kPressure;
  return has_gradients && kind == kind_of(other) && unit_of(one) == unit_of(other);
}

void add_difference(const std::string& one, const std::string& other, OwnedRecords& to) {
  for (Record& record : to.records) {
    const std::span<const double> a = values_of(record, one);
    const std::span<const double> b = values_of(record, other);
    Samples& difference = to.columns.emplace_back(a.size());
    double held_a = std::nan("");  // loggers may poll their thermometers alternately
    double held_b = std::nan("");
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (std::isfinite(a[i])) held_a = a[i];
      if (std::isfinite(b[i])) held_b = b[i];
      difference[i] = held_a - held_b;
    }
    record.channels.push_back({difference_of(one, other), difference});
  }
}

}  // namespace

double angle_period(const std::string& channel, std::span<const double> values) {
  const double period = turn_by_unit(channel);
  if (!(period > 0.0)) return 0.0;
  const std::optional<Turn> turn = turn_of(values, period);
  if (!turn) return 0.0;
  double low = turn->high;
  double high = turn->low;
  double before = std::nan("");
  std::size_t wraps = 0;
  std::size_t unsure = 0;
  for (const double value : values) {
    if (!turn->has(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
    const double jump = std::abs(value - before);
    wraps += jump > kWholeTurn * period ? 1 : 0;
    unsure += jump > 0.25 * period && jump < 0.75 * period ? 1 : 0;
    before = value;
  }
  const bool all_round = high - low > kWholeTurn * period;
  const bool clear = static_cast<double>(unsure) <= kUnsure * static_cast<double>(values.size());
  return all_round && wraps > 0 && clear ? period : 0.0;
}

OwnedRecords with_unwrapped_angles(OwnedRecords given) {
  std::map<std::string, double> periods;
  for (const Record& record : given.records)
    for (const RecordChannel& channel : record.channels)
      if (const double period = angle_period(channel.name, channel.values); period > 0.0)
        periods[channel.name] = period;
  for (Record& record : given.records) {
    for (RecordChannel& mine : record.channels) {
      const auto found = periods.find(mine.name);
      if (found == periods.end()) continue;
      const double period = found->second;
      Samples& whole = given.columns.emplace_back(mine.values);
      const std::optional<Turn> turn = turn_of(mine.values, period);
      double before = std::nan(""), first = 0.0;
      std::size_t outside = 0;
      for (double& value : whole) {
        if (turn && std::isfinite(value) && !turn->has(value)) {
          if (outside++ == 0) first = value;
          value = std::nan("");
        }
        if (!std::isfinite(value)) continue;
        if (std::isfinite(before)) value -= period * std::round((value - before) / period);
        before = value;
      }
      mine.values = whole;
      mine.period = period;
      if (outside > 0)
        given.remarks.push_back(
            mine.name + given.of_several(record) +
            formatted(" is outside the turn in %zu sample(s), first %.6g: no angle, dropped", outside,
                      first));
    }
  }
  return given;
}

OwnedRecords with_differences(OwnedRecords given) {
  std::vector<std::string> names;
  for (const RecordChannel& channel : given.records.front().channels)
    if (all_have(given.records, channel.name)) names.push_back(channel.name);
  std::size_t count = 0;
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = i + 1; j < names.size() && count < kMostDifferences; ++j) {
      if (!alike(names[i], names[j])) continue;
      add_difference(names[i], names[j], given);
      ++count;
    }
  return given;
}

}  // namespace ifog

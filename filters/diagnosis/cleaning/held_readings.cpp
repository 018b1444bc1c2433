// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <list>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "filters/diagnosis/cleaning/steps.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::size_t kFewestValues = 10;  // fewer are a switch's
// Changes between readings are whole numbers of holds apart, to a sample; those of a coarse reading are not.
constexpr double kOffWhole = 0.24, kSeldom = 0.05;
// Longer is a rate table's level, or a set point's.
constexpr double kLongestReference_s = 2.0, kLongestChannel_s = 60.0;

// Samples from one reading to the next, if all are held for as long and for at most `longest`; nullopt if every sample is
// a reading, or a coarse one stays the same by itself.
std::optional<std::size_t> held_for(std::span<const double> values, double longest) {
  std::vector<double> distances;
  std::set<double> different;
  std::size_t last = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) return std::nullopt;
    if (i > 0 && values[i] == values[i - 1]) continue;
    if (i > 0) distances.push_back(static_cast<double>(i - std::exchange(last, i)));
    if (different.size() < kFewestValues) different.insert(values[i]);
  }
  if (different.size() < kFewestValues) return std::nullopt;
  const auto seldom = static_cast<std::ptrdiff_t>(kSeldom * static_cast<double>(distances.size()));
  std::ranges::nth_element(distances, distances.begin() + seldom);
  const double least = distances[static_cast<std::size_t>(seldom)];
  if (least < 2.0) return std::nullopt;
  double samples = 0.0, holds = 0.0;
  for (const double each : distances) samples += each, holds += std::round(each / least);
  const double hold = samples / std::max(holds, 1.0), most = std::min(1.0, kOffWhole * hold);
  const auto off = std::ranges::count_if(
      distances, [&](double each) { return std::abs(each - hold * std::round(each / hold)) > most; });
  return off <= seldom && hold <= longest ? std::optional(static_cast<std::size_t>(std::lround(hold)))
                                          : std::nullopt;
}

// Samples that are readings; of one that stays the same, every `each`-th.
std::vector<std::size_t> readings_of(std::span<const double> values, std::size_t each) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (i == 0 || values[i] != values[i - 1] || i - places.back() >= each) places.push_back(i);
  return places;
}

// The record's rows at these places.
void keep_rows(Record& record, const std::vector<std::size_t>& places, std::list<Samples>& columns) {
  const auto keep = [&](std::span<const double>& values) {
    if (values.empty()) return;
    Samples& kept = columns.emplace_back(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) kept[i] = values[places[i]];
    values = kept;
  };
  keep(record.time_s);
  keep(record.rate_radps);
  keep(record.reference_radps);
  for (RecordChannel& channel : record.channels) keep(channel.values);
  for (RecordChannel& axis : record.other_axes) keep(axis.values);
  for (std::span<const double>& reference : record.other_references) keep(reference);
  const auto place = [&](std::size_t sample) {
    return static_cast<std::size_t>(std::ranges::lower_bound(places, sample) - places.begin());
  };
  for (Stretch& rest : record.at_rest) rest = {place(rest.begin), place(rest.end)};
  std::erase_if(record.at_rest, [](const Stretch& rest) { return rest.size() == 0; });
}

}  // namespace

OwnedRecords with_readings_alone(OwnedRecords given) {
  for (Record& record : given.records) {
    const auto rows = static_cast<double>(record.time_s.size());
    const double period_s = (record.time_s.back() - record.time_s.front()) / std::max(rows - 1.0, 1.0);
    const auto tell = [&](const std::string& name, std::size_t each) {
      given.remarks.push_back(name + " is read in every " + std::to_string(each) +
                              " samples and held between; only its readings are used" +
                              given.of_several(record));
    };
    if (const std::optional<std::size_t> each =
            held_for(record.reference_radps, kLongestReference_s / period_s)) {
      keep_rows(record, readings_of(record.reference_radps, *each), given.columns);
      tell(record.reference_name, *each);
      given.remarks.back() += formatted(
          ". So few samples make the angle random walk N up to %.2g times too large, and the predicted "
          "heading error",
          std::sqrt(static_cast<double>(*each)));
    }
    for (RecordChannel& channel : record.channels) {
      const std::optional<std::size_t> each = held_for(channel.values, kLongestChannel_s / period_s);
      if (!each) continue;
      Samples& alone =
          given.columns.emplace_back(channel.values.size(), std::numeric_limits<double>::quiet_NaN());
      for (const std::size_t i : readings_of(channel.values, *each)) alone[i] = channel.values[i];
      channel.values = alone;
      tell(channel.name, *each);
    }
  }
  return given;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "filters/diagnosis/cleaning/steps.h"

namespace ifog {
namespace {

constexpr std::size_t kFewest = 20;  // changes
// Of a reading that is held no change follows sooner than this share of the usual distance; of a coarse reading many do.
constexpr double kSoon = 0.6, kSeldom = 0.05;

// Samples from one reading to the next, if all are held for as long; nullopt if every sample is a reading, or a coarse
// one stays the same by itself.
std::optional<std::size_t> held_for(std::span<const double> values) {
  std::vector<std::size_t> distances;
  std::size_t last = 0;
  double before = std::nan("");
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) return std::nullopt;
    if (values[i] == before) continue;
    if (i > 0) distances.push_back(i - last);
    last = i;
    before = values[i];
  }
  if (distances.size() < kFewest) return std::nullopt;
  const auto middle = distances.begin() + std::ssize(distances) / 2;
  std::ranges::nth_element(distances, middle);
  const std::size_t usual = *middle;
  const auto soon = std::ranges::count_if(distances, [&](std::size_t each) {
    return static_cast<double>(each) < kSoon * static_cast<double>(usual);
  });
  const bool regular = static_cast<double>(soon) <= kSeldom * static_cast<double>(distances.size());
  return usual > 1 && regular ? std::optional(usual) : std::nullopt;
}

// The readings alone, NaN between them; of one that stays the same, every `each`-th sample.
Samples readings_of(std::span<const double> values, std::size_t each) {
  Samples out(values.size(), std::numeric_limits<double>::quiet_NaN());
  std::size_t last = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0 && values[i] == values[i - 1] && i - last < each) continue;
    out[i] = values[i];
    last = i;
  }
  return out;
}

}  // namespace

OwnedRecords with_readings_alone(OwnedRecords given) {
  for (Record& record : given.records) {
    const auto leave_out_held = [&](std::span<const double>& values, const std::string& name) {
      const std::optional<std::size_t> each = held_for(values);
      if (!each) return;
      values = given.columns.emplace_back(readings_of(values, *each));
      given.remarks.push_back(name + " is a new reading in every " + std::to_string(*each) +
                              " samples and held between; the held ones are left out" +
                              given.of_several(record));
    };
    leave_out_held(record.reference_radps, record.reference_name);
    for (std::size_t a = 0; a < record.other_references.size(); ++a)
      leave_out_held(record.other_references[a], "the reference of " + record.other_axes[a].name);
    for (RecordChannel& channel : record.channels) leave_out_held(channel.values, channel.name);
  }
  return given;
}

}  // namespace ifog

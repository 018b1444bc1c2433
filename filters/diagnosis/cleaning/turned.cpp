// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/steps.h"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "filters/allan/stretches.h"
#include "filters/rest/rest.h"
#include "filters/rest/value_faults.h"

namespace ifog {
namespace {

// Sample period; nullopt without an even clock, e.g. a list of dwells.
std::optional<double> period_of(const Record& record) {
  try {
    return sample_clock(record.time_s).period_s;
  } catch (const std::invalid_argument&) {
    return {};
  }
}

// With the texts of `allan` and `tune`.
void note_value_faults(const Record& record, const Rest& rest, std::vector<std::string>& remarks) {
  const SampleClock clock = sample_clock(record.time_s);
  const std::vector<Stretch> parts = common(stretches(record.time_s, record.rate_radps, clock), rest.at_rest);
  std::vector<ValueFault> faults;
  find_value_faults(record.rate_radps, parts, clock.period_s, faults);
  for (const ValueFault& found : faults) remarks.push_back(record.name + ": " + found.text);
}

}  // namespace

OwnedRecords without_turns(OwnedRecords given) {
  for (Record& record : given.records) {
    const std::optional<double> period = period_of(record);
    if (!record.reference_radps.empty() || !period) continue;
    const double period_s = *period, start_s = record.origin.in_s(record.time_s.front());
    std::vector<std::span<const double>> axes{record.rate_radps};
    for (const RecordChannel& other : record.other_axes) axes.push_back(other.values);
    const Rest rest = find_rest(axes, {}, period_s);
    note_value_faults(record, rest, given.remarks);
    record.at_rest = rest.at_rest;
    std::string moving;
    try {
      require_rest(rest, period_s, start_s);
    } catch (const std::invalid_argument& error) {
      moving = error.what();
    }
    if (rest.turned == 0) {
      // Vibration may be what is tested.
      if (!moving.empty())
        given.remarks.push_back(record.name + ": " + in_words(rest, period_s, start_s) +
                                "; its noise and its lines are also those of the shaking");
      continue;
    }
    if (!moving.empty()) throw std::invalid_argument(moving + ", or a reference rate");
    Samples& rate = given.columns.emplace_back(record.rate_radps.size(), std::nan(""));
    for (const Stretch& part : rest.at_rest)
      for (std::size_t i = part.begin; i < part.end; ++i) rate[i] = record.rate_radps[i];
    record.rate_radps = rate;
    given.remarks.push_back(record.name + ": " + in_words(rest, period_s, start_s) +
                            "; only the rest is diagnosed");
  }
  return given;
}

}  // namespace ifog

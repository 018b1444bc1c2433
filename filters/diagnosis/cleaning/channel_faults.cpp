// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/steps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

#include "filters/allan/stretches.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/effects/plausible_reading.h"
#include "filters/rest/cleaned_rate.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::size_t kLookedAt = 50000;  // values examined for the usual range
constexpr std::size_t kFewest = 100;      // fewest values for a usual range
constexpr std::size_t kFewValues = 5;     // of a switch or a state
constexpr double kMostFaults = 0.1;  // share of the readings; more frequent values are a state of the channel
constexpr double kLongest_s = 60.0;  // longest interpolation
constexpr std::size_t kLearned = 1000;  // samples used to initialise the rule

using Flags = std::vector<std::uint8_t>;

// Number of equal values at the start of a sorted list that are a placeholder (9999 or 85 °C): one value,
// farther from all others than most of these are from each other. Zero is none; a channel that is switched
// off reads zero.
std::size_t placeholders_of(const std::vector<double>& values) {
  const std::size_t n = values.size();
  const auto most = static_cast<std::size_t>(kMostFaults * static_cast<double>(n));
  const double first = values.front();
  const auto other = std::ranges::find_if(values, [&](double v) { return v != first; });
  const auto times = static_cast<std::size_t>(other - values.begin());
  if (first == 0.0 || times > most) return 0;
  return std::abs(*other - first) > std::abs(values[n - 1 - most] - *other) ? times : 0;
}

// From the 1 % to the 99 % quantile.
std::optional<ChannelRange> usual_range(std::span<const double> column) {
  std::vector<double> values;
  const std::size_t stride = std::max<std::size_t>(1, column.size() / kLookedAt);
  for (std::size_t i = 0; i < column.size(); i += stride)
    if (std::isfinite(column[i])) values.push_back(column[i]);
  if (values.size() < kFewest) return std::nullopt;
  std::ranges::sort(values);
  const std::vector<double> falling(values.rbegin(), values.rend());
  const std::size_t below = placeholders_of(values), above = placeholders_of(falling);
  const std::span<const double> used = std::span(values).subspan(below, values.size() - below - above);
  if (std::set<double>(used.begin(), used.end()).size() <= kFewValues) return std::nullopt;
  const auto at = [&](double share) {
    return used[static_cast<std::size_t>(share * static_cast<double>(used.size() - 1))];
  };
  return ChannelRange{"", at(0.01), at(0.99)};
}

// By sample, whether the rule rejects the reading forwards or backwards in time. A record may begin with a
// fault, so the rule first learns from the first samples.
Flags refused(const Record& record, std::span<const double> column, const ChannelRange& range,
              bool forwards) {
  const std::size_t n = column.size();
  PlausibleReading rule;
  const auto step = [&](std::size_t i, std::size_t before) {
    const std::size_t at = forwards ? i : n - 1 - i, last = forwards ? before : n - 1 - before;
    return rule.step(column[at], std::abs(record.time_s[at] - record.time_s[last]), range);
  };
  for (std::size_t i = std::min(kLearned, n - 1); i > 0; --i) static_cast<void>(step(i, i - 1));
  Flags found(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const bool believed = step(i, i > 0 ? i - 1 : 0);
    const std::size_t at = forwards ? i : n - 1 - i;
    found[at] = !believed && std::isfinite(column[at]) ? 1 : 0;
  }
  return found;
}

// Linear interpolation between the readings on either side of each fault, or the one that exists; missing if
// the fault is longer than a minute.
Samples interpolated(const Record& record, std::span<const double> column, const Flags& fault) {
  Samples values(column);
  const auto believed = [&](std::size_t i) { return std::isfinite(column[i]) && !fault[i]; };
  std::optional<std::size_t> before;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (believed(i)) before = i;
    if (!fault[i]) continue;
    std::size_t behind = i;
    while (behind < values.size() && !believed(behind)) ++behind;
    const bool ends = behind == values.size();
    const std::size_t from = before.value_or(behind), to = ends ? from : behind;
    const bool brief = record.time_s[behind - 1] - record.time_s[i] <= kLongest_s;
    for (; i < behind; ++i) {
      if (!fault[i]) continue;
      const double span_s = record.time_s[to] - record.time_s[from];
      const double share = span_s > 0.0 ? (record.time_s[i] - record.time_s[from]) / span_s : 0.0;
      values[i] = brief ? column[from] + share * (column[to] - column[from]) : std::nan("");
    }
    if (!ends) before = behind;
  }
  return values;
}

struct RepairedChannel {
  Samples values;  // empty: no fault
  std::string remark;
};

RepairedChannel repaired_channel(const Record& record, const RecordChannel& channel,
                                 const std::string& where) {
  const std::span<const double> column = channel.values;
  const std::optional<ChannelRange> range = usual_range(column);
  if (!range) return {};
  Flags fault = refused(record, column, *range, true);
  const Flags backwards = refused(record, column, *range, false);
  std::size_t samples = 0, times = 0, first = 0, readings = 0;
  bool within = false;
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (!std::isfinite(column[i])) continue;
    ++readings;
    fault[i] = fault[i] && backwards[i] ? 1 : 0;
    if (fault[i] && samples++ == 0) first = i;
    if (fault[i] && !within) ++times;
    within = fault[i] != 0;
  }
  if (samples == 0 || static_cast<double>(samples) > kMostFaults * static_cast<double>(readings)) return {};
  return {interpolated(record, column, fault),
          channel.name + where +
              formatted(" leaps away and back %zu time(s), for %zu sample(s) in all, first to %.6g: treated "
                        "as faults of logging, interpolated for up to a minute",
                        times, samples, column[first])};
}

}  // namespace

OwnedRecords repair_channels(OwnedRecords given) {
  for (Record& record : given.records)
    for (RecordChannel& channel : record.channels) {
      RepairedChannel repaired = repaired_channel(record, channel, given.of_several(record));
      if (repaired.values.empty()) continue;
      channel.values = given.columns.emplace_back(std::move(repaired.values));
      given.remarks.push_back(std::move(repaired.remark));
    }
  return given;
}

OwnedRecords without_leaping_rates(OwnedRecords given) {
  for (Record& record : given.records) {
    const bool plain = record.reference_radps.empty();
    const Samples less_reference = plain ? Samples() : error_of(record);
    const std::span<const double> error = plain ? record.rate_radps : std::span<const double>(less_reference);
    std::vector<ValueFault> faults;
    std::optional<Samples> cleaned = without_leaps(
        record.rate_radps, error, stretches({}, error, {}),
        [&](std::size_t i) { return record.origin.in_s(record.time_s[i]); }, faults);
    for (const ValueFault& fault : faults)
      given.remarks.push_back("the rate" + given.of_several(record) + ": " + fault.text);
    if (!cleaned) continue;
    record.rate_radps = given.columns.emplace_back(*std::move(cleaned));
  }
  return given;
}

}  // namespace ifog

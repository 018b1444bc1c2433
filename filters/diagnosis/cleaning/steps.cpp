// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/steps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "drivers/row_times/sample_clock.h"
#include "filters/allan/stretches.h"
#include "filters/diagnosis/channels/derived_channels.h"
#include "filters/diagnosis/cleaning/prepared_records.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/linear/columns.h"
#include "filters/linear/normal_equations.h"
#include "filters/rest/rest.h"
#include "filters/rest/value_faults.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::size_t kStampsApart = 16;
constexpr double kOwnLengths = 4.0;

// A late stamp lengthens one step and shortens the next, so sums of steps scatter like one step. For steps of
// different lengths the sum's variance is the sum.
bool keeps_a_beat(std::span<const double> time_s, const SampleClock& clock) {
  const double period = clock.period_s;
  double one = 0.0, many = 0.0;
  for (std::size_t i = kStampsApart; i < time_s.size(); i += kStampsApart) {
    const double step = time_s[i] - time_s[i - 1] - period;
    const double sum = time_s[i] - time_s[i - kStampsApart] - static_cast<double>(kStampsApart) * period;
    if (std::abs(sum) > 2.0 * period) continue;  // a gap
    one += step * step;
    many += sum * sum;
  }
  return many < kOwnLengths * one;
}

std::string in_words(const Record& record, const SampleClock& clock) {
  return record.name + formatted(
                           ": the time stamps are up to %.3g ms off an even clock of %.6g Hz, so samples "
                           "are placed by that clock, which restarts behind each hole",
                           1e3 * clock.worst_jitter_s, 1.0 / clock.period_s);
}

}  // namespace

OwnedRecords with_even_stamps(OwnedRecords given) {
  for (Record& record : given.records) {
    const SampleClock clock = sample_clock(record.time_s);
    if (!clock.scatters() || clock.period_s > kSlowest_s || !keeps_a_beat(record.time_s, clock)) continue;
    RowTimes times(record.time_s, clock);
    Samples& even = given.columns.emplace_back(record.time_s.size());
    for (std::size_t i = 0; i < even.size(); ++i)
      even[i] = record.time_s.front() + times.next(record.time_s[i]);
    given.remarks.push_back(in_words(record, clock));
    record.time_s = even;
  }
  return given;
}

namespace {

// The measured rate without its regression of measured rate minus reference on all moving references; unchanged if
// there are too few samples.
Samples less_its_own(std::span<const double> measured, std::span<const double> reference,
                     const std::vector<std::span<const double>>& along) {
  const auto vector = [](std::span<const double> values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  };
  const auto axes = static_cast<Eigen::Index>(along.size());
  Columns columns = Columns::Ones(vector(measured).size(), 2 + axes);
  columns.col(0) = vector(measured) - vector(reference);
  for (Eigen::Index a = 0; a < axes; ++a) columns.col(2 + a) = vector(along[static_cast<std::size_t>(a)]);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  Eigen::Index complete = 0;
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    if (!columns.row(i).allFinite()) continue;
    gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.row(i).transpose());
    ++complete;
  }
  if (complete < 10 * columns.cols()) return Samples(measured);
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  const Eigen::VectorXd shares = NormalEquations::of_measured_first(gram).coefficients().tail(axes);
  const Eigen::VectorXd corrected = vector(measured) - columns.rightCols(axes) * shares;
  return Samples(std::span<const double>(corrected.data(), measured.size()));
}

}  // namespace

OwnedRecords with_other_axes(OwnedRecords given) {
  const auto referenced = [](const Record& record) { return moves(record.reference_radps); };
  if (!std::ranges::all_of(given.records, referenced)) return given;
  for (Record& record : given.records) {
    std::vector<std::span<const double>> along{record.reference_radps};
    for (const std::span<const double> reference : record.other_references)
      if (moves(reference)) along.push_back(reference);
    for (std::size_t a = 0; a < record.other_axes.size(); ++a) {
      RecordChannel axis = record.other_axes[a];
      if (a < record.other_references.size() && moves(record.other_references[a]))
        axis.values =
            given.columns.emplace_back(less_its_own(axis.values, record.other_references[a], along));
      record.channels.push_back(axis);
    }
  }
  return given;
}

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

namespace {

// Wraps are removed before faults are searched, and differences are formed of repaired channels.
OwnedRecords cleaned(const std::vector<Record>& captures) {
  check_columns(captures);
  OwnedRecords channels = with_differences(
      repair_channels(with_unwrapped_angles(with_readings_alone(with_even_stamps(captures)))));
  return without_turns(with_other_axes(without_leaping_rates(align_references(std::move(channels)))));
}

}  // namespace

PreparedRecords::PreparedRecords(const std::vector<Record>& captures, const TimeShare& share,
                                 double significance)
    : whole(cleaned(captures)),
      fitted(share.whole() ? whole.records : fitted_parts(whole.records, share)),
      without_ramps(take_out_ramps(fitted, significance)) {}

}  // namespace ifog

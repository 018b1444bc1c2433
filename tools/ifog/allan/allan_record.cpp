// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/allan/allan_record.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"
#include "filters/rest/rest.h"
#include "filters/threads/share_out.h"
#include "filters/units/told_time.h"
#include "tools/ifog/captures/usable_axes.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

// Rates analysed in parallel, even with fewer processors: three on two processors in turn would leave one
// idle.
constexpr unsigned kRatesTogether = 3;

// "rate_x_radps" → signal "rate", axis "x"; likewise for a denoised file. False for other columns.
bool signal_of(const std::string& column, std::string& signal, std::string& axis) {
  for (const char* const prefix : {"rate", "raw", "compensated", "denoised"})
    if (axis_of(column, prefix, axis)) {
      signal = prefix;
      return true;
    }
  return false;
}

// True if the rows have no value at all.
bool is_dead(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isnan(value); });
}

// Finds rest from all axes of the sensor together, because a turn about one disturbs the others. Uses the raw
// rates of a file written by denoise.
void find_rest_of(AnalysedPart& part, const AllanOptions& options) {
  const TimePart::Rows& rows = part.rows;
  std::vector<std::span<const double>> axes, references;
  std::string signal, axis;
  for (const LongColumn& column : part.table.columns) {
    const std::span<const double> values = rows.of(column.values);
    if (axis_of(column.name, "reference_rate", axis))
      references.push_back(values);
    else if ((is_other_rate(column.name) ||
              (signal_of(column.name, signal, axis) && (signal == "rate" || signal == "raw"))) &&
             !is_dead(values))
      axes.push_back(values);
  }
  part.rest.samples = rows.end - rows.begin;
  part.rest.at_rest = {{0, part.rest.samples}};
  if (options.keep_motion || axes.empty()) return;
  const double period_s = part.clock.period_s;
  const Rest found = find_rest(axes, references, period_s);
  if (options.minus_reference) {
    // With a reference the sensor may turn.
    if (found.turned > 0)
      part.slow_turns =
          "turned in " + six_digits(static_cast<double>(found.turned) * period_s) +
          " s: the scale factor's error against the reference remains, which is no noise; ifog diagnose "
          "takes it out";
    return;
  }
  part.rest = found;
  try {
    require_rest(part.rest, period_s, part.shown_time_s(0));
  } catch (const std::invalid_argument& error) {
    throw refusal("{}: {}{}, or --moving keep{}", part.capture, error.what(),
                  references.empty() ? "" : ", or --minus-reference",
                  references.empty() ? "" : "; a sensor turned with a reference is for ifog diagnose");
  }
  part.slow_turns = slow_turns_in_words(part.rest, period_s, part.shown_time_s(0));
}

Samples less_reference(const std::string& name, const LongTable& table, std::span<const double> rate,
                       const std::string& axis) {
  const std::string wanted = of_axis("reference_rate", axis) + "_radps";
  const LongColumn* const reference = table.column(wanted);
  if (reference == nullptr)
    throw refusal("{}: no column {}, expected one for --minus-reference", name, wanted);
  Samples error;
  error.reserve(rate.size());
  for (std::size_t i = 0; i < rate.size(); ++i) error.push_back(rate[i] - reference->values[i]);
  return error;
}

// Number of leading rows with equal values in both; two missing values are equal.
std::size_t same_rows(std::span<const double> a, std::span<const double> b) {
  std::size_t i = 0;
  while (i < a.size() && (a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])))) ++i;
  return i;
}

// Number of leading rows in which a denoised rate equals the compensated one; 0 for other signals and if they
// never differ. Until the filter knows the noise it publishes the compensated rate, whose noise and jumps are
// not the filter's.
std::size_t start_of_filter(const LongTable& table, const LoggedRate& logged) {
  if (logged.signal != "denoised") return 0;
  const LongColumn* const before = table.column(of_axis("compensated", logged.axis) + "_radps");
  const std::size_t same = before == nullptr ? 0 : same_rows(logged.column.values, before->values);
  return same < table.size() ? same : 0;
}

// The rates to analyse; throws if there are none.
std::vector<LoggedRate> rates_of(const AnalysedPart& part, const std::string& wanted) {
  const std::string& name = part.capture;
  const TimePart::Rows& rows = part.rows;
  std::vector<LoggedRate> rates;
  std::string signal, axis;
  std::vector<std::string> axes, left_out;
  for (const LongColumn& column : part.table.columns) {
    if (!signal_of(column.name, signal, axis)) continue;
    if (std::ranges::find(axes, axis) == axes.end()) axes.push_back(axis);
    if (!wanted.empty() && axis != wanted) continue;
    if (is_dead(rows.of(column.values)))
      left_out.push_back(of_axis(signal, axis));
    else
      rates.push_back({part, column, signal, axis, rows.of(column.values)});
  }
  if (axes.empty())
    fail_at(name, part.table.header_line,
            "no rate column, expected 'rate_radps', 'rate_x_radps', … or those of `ifog denoise`");
  if (rates.empty() && left_out.empty())
    throw refusal("{}: --axis is {}, expected {}", name, in_quotes(wanted), expected_axes(axes));
  if (rates.empty()) refuse_without_rates(name, rows.end - rows.begin);
  for (const std::string& dead : left_out) tell_left_out(name, dead, rows.end - rows.begin);
  return rates;
}

AllanRecord record_of(LoggedRate logged, const AllanOptions& options) {
  const AnalysedPart& of = logged.of;
  const TimePart::Rows& rows = of.rows;
  Samples error;
  if (options.minus_reference && logged.signal == "rate") {
    error = less_reference(of.capture, of.table, logged.column.values, logged.axis);
    logged.rate = rows.of(error);
    logged.signal = "error";
  }
  // A part that ends before the filter starts is shown as it is.
  const std::size_t started = start_of_filter(of.table, logged);
  const bool later = started > rows.begin && started < rows.end;
  const std::vector<Stretch> running = {{later ? started - rows.begin : 0, rows.end - rows.begin}};
  Rest analysed = of.rest;
  analysed.at_rest = common(of.rest.at_rest, running);
  AllanRecord record = analyse(logged, analysed, options);
  if (later)
    record.notes.push_back(of.capture + ": " + logged.column.name + ": until " +
                           told_time(of.shown_time_s(started - rows.begin)) +
                           " s the filter had not started and this is the compensated rate: dropped");
  if (const std::string motion = in_words(of.rest, of.clock.period_s, of.shown_time_s(0)); !motion.empty())
    record.notes.push_back(of.capture + ": " + motion + "; only the rest is analysed");
  if (!of.slow_turns.empty()) record.notes.push_back(of.capture + ": " + of.slow_turns);
  return record;
}

}  // namespace

std::string AllanRecord::label() const {
  return signal == "rate" ? axis : axis.empty() ? signal : signal + " " + axis;
}

bool allan_wants(const std::string& column) {
  std::string signal, axis;
  return signal_of(column, signal, axis) || axis_of(column, "reference_rate", axis) || is_other_rate(column);
}

std::vector<AllanRecord> allan_records(const std::string& name, const LongTable& table,
                                       const AllanOptions& options) {
  const TimePart::Rows rows = options.part.rows(table.time_s, table.origin, name);
  const std::span<const double> time_s = rows.of(table.time_s);
  if (time_s.size() < 3) throw refusal("{}: {} samples, expected at least 3", name, time_s.size());
  AnalysedPart part{name, table, rows, time_s, naming(name, [&] { return sample_clock(time_s); })};
  find_rest_of(part, options);
  const std::vector<LoggedRate> rates = rates_of(part, options.axis);
  // In parallel. An axis that fails is skipped; if all fail, the first error is thrown.
  std::vector<AllanRecord> records(rates.size());
  std::vector<std::exception_ptr> refused(rates.size());
  share_out(rates.size(), std::max(kRatesTogether, std::thread::hardware_concurrency()), [&](std::size_t i) {
    try {
      records[i] = record_of(rates[i], options);
    } catch (...) {
      refused[i] = std::current_exception();
    }
  });
  std::vector<AllanRecord> analysed;
  for (std::size_t i = 0; i < rates.size(); ++i)
    if (!refused[i]) analysed.push_back(std::move(records[i]));
  for (const std::exception_ptr& each : refused) {
    if (!each) continue;
    if (analysed.empty()) std::rethrow_exception(each);
    try {
      std::rethrow_exception(each);
    } catch (const std::runtime_error& error) {
      warn("{}: the axis is dropped\n", error.what());
    }
  }
  return analysed;
}

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/allan/allan_record.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>

#include "drivers/row_times/sample_clock.h"
#include "filters/allan/noise/curve_miss.h"
#include "filters/rest/cleaned_rate.h"
#include "filters/rest/followed_channel.h"
#include "filters/rest/value_faults.h"
#include "filters/units/field_units.h"
#include "filters/units/told_time.h"
#include "tools/ifog/captures/usable_axes.h"
#include "tools/ifog/console/errors.h"

namespace ifog::tools {
namespace {

constexpr double kTrustedDegrees = 8.0;  // d.o.f.; the relative error 1/√(2·8) of the deviation is 25 %

const char* words_for(Deviation kind) {
  return kind == Deviation::kModified   ? "the modified deviation"
         : kind == Deviation::kHadamard ? "the Hadamard deviation"
                                        : "the overlapping deviation";
}

// The averaging times that the user wants and this rate has; notes tell of the others, and of those that are no
// multiple of the period. Throws std::runtime_error if none is left.
std::vector<std::size_t> asked_multiples(const std::string& name, const AllanOptions& options, double period,
                                         AllanRecord& record) {
  std::vector<std::size_t> m;
  const std::size_t most = longest_average(options.kind, record.longest);
  std::string outside;
  for (const double tau : options.tau_s) {
    const double exact = tau / period;
    if (!(exact >= 0.5 && std::round(exact) <= static_cast<double>(most))) {
      outside = fmt::format(
          "{}: --tau {} s is outside what {} can tell of the longest stretch, expected {} to {} s", name,
          six_digits(tau), words_for(options.kind), six_digits(period),
          six_digits(static_cast<double>(most) * period));
      record.notes.push_back(outside);
      continue;
    }
    m.push_back(static_cast<std::size_t>(std::max(1.0, std::round(exact))));
    const double used = static_cast<double>(m.back()) * period;
    if (std::abs(used / tau - 1.0) > 1e-6)
      record.notes.push_back(fmt::format("{}: --tau {} s is no multiple of the sample time; used: {} s", name,
                                         six_digits(tau), six_digits(used)));
  }
  if (m.empty()) throw refusal("{}", outside);
  return m;
}

double trusted_tau(const AngleSum& sum, const TermVariances& noise, Deviation kind, double period) {
  std::vector<std::size_t> samples;
  for (const AngleSum::Part& part : sum.parts()) samples.push_back(part.angles - 1);
  double trusted = 0.0;
  for (std::size_t m = 1; m <= longest_average(kind, sum.longest()); m *= 2)
    if (EstimateVariance(kind, m, samples).degrees(noise) >= kTrustedDegrees)
      trusted = static_cast<double>(m) * period;
  return trusted;
}

// Adds notes about gaps and uneven time stamps. Throws std::runtime_error if gaps are refused.
void note_holes(const LoggedRate& logged, bool refuse, AllanRecord& record) {
  const SampleClock& clock = logged.of.clock;
  const auto note = [&](std::size_t row, const std::string& what) {
    if (refuse) throw refusal("{}: {}, expected none", logged.of.place(row), what);
    record.notes.push_back(logged.of.place(row) + ": " + what);
  };
  std::size_t nans = 0, first_nan = 0;
  for (std::size_t i = 0; i < logged.rate.size(); ++i)
    if (std::isnan(logged.rate[i]) && nans++ == 0) first_nan = i;
  record.missing = nans + clock.missing;
  if (clock.gaps > 0)
    note(clock.first_gap, std::to_string(clock.gaps) + (clock.gaps == 1 ? " gap" : " gaps") +
                              " in the time column (" + std::to_string(clock.missing) +
                              " samples missing), the first after " +
                              told_time(logged.of.shown_time_s(clock.first_gap)) + " s");
  if (nans > 0)
    note(first_nan,
         missing_in_words(logged.name(), nans, logged.rate.size(), logged.of.shown_time_s(first_nan)));
  if (clock.worst_jitter_s > 0.1 * clock.period_s)
    record.notes.push_back(logged.of.capture + ": time is uneven by up to " +
                           six_digits(clock.worst_jitter_s * 1e3) +
                           " ms; treated as jitter of the stamps of an even clock of " +
                           six_digits(record.sample_rate_hz) + " Hz");
}

// Computes the deviations, their intervals and the noise coefficients.
void measure(const LoggedRate& logged, const AngleSum& sum, const AllanOptions& options, double period,
             AllanRecord& record) {
  const std::string& name = logged.of.capture;
  // Longer averages have too few differences.
  const std::vector<std::size_t> m =
      options.tau_s.empty() ? log_spaced(std::max<std::size_t>(1, record.longest / 4), options.per_decade)
                            : asked_multiples(name, options, period, record);
  try {
    record.fit = noise_coefficients(sum, period);
  } catch (const std::invalid_argument& error) {
    record.notes.push_back(name + ": " + logged.name() + ": no coefficients: " + error.what());
  }
  const TermVariances noise = record.fit ? record.fit->variances : TermVariances{};
  record.points = deviation(sum, m, options.kind);
  record.intervals = allan_intervals(sum, options.kind, record.points, noise, options.confidence);
  // Terms equivalent to a Gauss-Markov bias at each τ.
  if (record.fit && record.fit->markov && record.fit->markov->present)
    for (std::size_t i = 0; i < m.size(); ++i)
      record.intervals[i] =
          allan_intervals(sum, options.kind, std::span(record.points).subspan(i, 1),
                          equivalent_terms(record.fit->markov->fit, static_cast<double>(m[i])),
                          options.confidence)
              .front();
  if (options.long_tau) record.longer = theo1(sum, noise, options.confidence, options.per_decade);
  for (LongPoint& point : record.longer) point.tau *= period;
  for (const std::size_t k : m) record.tau_s.push_back(static_cast<double>(k) / record.sample_rate_hz);
  record.trusted_tau_s = trusted_tau(sum, noise, options.kind, period);
}

}  // namespace

std::string AnalysedPart::place(std::size_t row) const {
  row += rows.begin;
  const std::size_t line = table.line_of_row(row);
  return capture + (line > 0 ? ":" + std::to_string(line) : ": sample " + std::to_string(row));
}

std::string six_digits(double value) { return fmt::format("{:.6g}", value); }

AllanRecord analyse(const LoggedRate& logged, const Rest& rest, const AllanOptions& options) {
  const std::string &name = logged.of.capture, &signal = logged.signal, column = logged.name();
  AllanRecord record;
  record.capture = name;
  record.axis = logged.axis;
  record.signal = signal;
  record.sample_rate_hz = rounded_rate(logged.of.clock.period_s);
  record.gaps = logged.of.clock.gaps;
  const double period = 1.0 / record.sample_rate_hz;
  note_holes(logged, options.refuse_gaps, record);
  const auto add = [&](const std::string& text) {
    record.notes.push_back(name + ": " + column + ": " + text);
  };

  const std::vector<Stretch> parts =
      common(stretches(logged.of.time_s, logged.rate, logged.of.clock), rest.at_rest);
  if (parts.empty()) throw refusal("{}: {} has no values", name, column);
  const auto shown_time_s = [&](std::size_t row) { return logged.of.shown_time_s(row); };
  // A filter's gain makes jumps of its own; faults of the logger are visible in the raw rate.
  record.findings = logged.column.repeats;
  std::optional<Samples> cleaned;
  if (signal != "denoised" && !options.keep_motion)
    cleaned = without_leaps(logged.rate, logged.rate, parts, shown_time_s, record.findings);
  const std::span<const double> rate = cleaned ? *cleaned : logged.rate;
  if (signal == "rate") find_value_faults(rate, parts, period, record.findings);
  for (const ValueFault& found : record.findings) add(found.text);
  const AngleSum sum(rate, parts);
  record.samples = sum.samples();
  record.longest = sum.longest();
  record.mean_radps = sum.mean_radps();
  if (record.longest < 2)
    throw refusal("{}: {} has no two samples in a row, expected a record without so many gaps", name, column);
  if (sum.filled() > 0)
    add("averages reach across " + std::to_string(sum.filled()) +
        (sum.filled() == 1 ? " missing sample" : " missing samples") +
        ", filled with the mean of their neighbours: at most 2 % of a variance");
  if (sum.parts().size() > 1)
    record.notes.push_back(name + ": " + column + " is analysed in " + std::to_string(sum.parts().size()) +
                           " stretches; averages reach across no hole between them, the longest stretch is " +
                           six_digits(static_cast<double>(record.longest) * period) + " s");

  measure(logged, sum, options, period, record);
  const auto fits_badly = [&](const std::string& text) { record.findings.push_back({"curve", text}); };
  if (record.fit) {
    if (const std::string miss = curve_miss_in_words(*record.fit); !miss.empty()) fits_badly(miss);
    for (const std::string& miss : misfit_in_words(*record.fit)) add(miss);
  }
  if (const auto followed = record.fit && signal == "rate"
                                ? followed_channel(rate, parts, logged.of.rows.begin, period,
                                                   logged.of.table.outlines, *record.fit)
                                : std::nullopt) {
    fits_badly(fmt::format(
        "slow means of the rate follow {} by {:.2g} % of their variance: an effect of it would pass "
        "for noise, and the error bars of B, K and R allow for that; run ifog diagnose",
        followed->name, 100.0 * followed->share));
    add(record.findings.back().text);
  }
  record.noise_changes = noise_changes(rate, parts, period, shown_time_s);
  if (const std::string change = in_words(record.noise_changes); !change.empty()) add(change);
  return record;
}

}  // namespace ifog::tools

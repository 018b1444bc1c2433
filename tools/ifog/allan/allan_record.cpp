// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/allan/allan_record.h"
#include "filters/units/field_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <utility>

#include "drivers/capture/column_names.h"
#include "drivers/ifog/quoted.h"
#include "filters/allan/row_times.h"
#include "filters/rest/glitches.h"
#include "filters/rest/rest.h"
#include "filters/units/told_time.h"
#include "tools/ifog/allan/filter_start.h"
#include "tools/ifog/allan/rate_signal.h"
#include "tools/ifog/captures/usable_axes.h"

namespace ifog::tools {
namespace {

constexpr double kTrustedDegrees = 8.0;  // relative error of the deviation 1/√(2·8), a quarter

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

const char* words_for(Deviation kind) {
  return kind == Deviation::kModified   ? "the modified deviation"
         : kind == Deviation::kHadamard ? "the Hadamard deviation"
                                        : "the overlapping deviation";
}

std::vector<std::size_t> asked_multiples(const std::string& name, const AllanOptions& options, double period,
                                         std::size_t samples) {
  std::vector<std::size_t> m;
  for (const double tau : options.tau_s) {
    const double exact = tau / period;
    const std::size_t most = longest_average(options.kind, samples);
    if (!(exact >= 0.5 && std::round(exact) <= static_cast<double>(most)))
      throw std::runtime_error(name + ": --tau " + number(tau) + " s is outside what " +
                               words_for(options.kind) + " can tell of the longest stretch, expected " +
                               number(period) + " to " + number(static_cast<double>(most) * period) + " s");
    m.push_back(static_cast<std::size_t>(std::max(1.0, std::round(exact))));
  }
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

std::string in_words(const std::vector<FrequencyRange>& ranges) {
  constexpr std::size_t kShown = 6;
  std::string words;
  for (std::size_t i = 0; i < std::min(kShown, ranges.size()); ++i)
    words += (i > 0 ? ", " : "") + number(ranges[i].low) + "–" + number(ranges[i].high);
  if (ranges.size() > kShown) words += " and " + std::to_string(ranges.size() - kShown) + " more";
  return words + " Hz";
}

void note_what_was_left_out(const std::string& column, AllanRecord& record) {
  const std::string start = record.capture + ": " + column + ": ";
  if (!record.fit->lines_hz.empty())
    record.notes.push_back(start + "lines, left out of the noise terms: " + in_words(record.fit->lines_hz));
  if (!record.fit->left_out_hz.empty())
    record.notes.push_back(start +
                           "left out of the noise terms, because no sum of them comes near (resonance, "
                           "vibration, a filter): " +
                           in_words(record.fit->left_out_hz));
  const std::string markov = markov_in_words(*record.fit);
  if (!markov.empty()) record.notes.push_back(start + markov);
  if (record.fit->misfit > 0.0 && markov.empty())
    record.notes.push_back(start + "the terms miss the curve by " + number(100.0 * record.fit->misfit) +
                           " % beyond chance; the error bars allow for it");
}

// Where a row stands in its file: "file:line", or the sample's number where the file is no text.
class Gaps {
 public:
  Gaps(std::string file, const RowNotes& lines, std::size_t first_row)
      : file_(std::move(file)), lines_(lines), first_row_(first_row) {}
  [[nodiscard]] std::string place(std::size_t row) const {
    const std::size_t line = lines_.line_of_row(row + first_row_);
    return line > 0 ? file_ + ":" + std::to_string(line)
                    : file_ + ": sample " + std::to_string(row + first_row_);
  }

 private:
  std::string file_;
  const RowNotes& lines_;
  std::size_t first_row_;
};

// No value at all in a column's rows.
bool is_dead(const SeriesView& values) {
  bool dead = true;
  for_each_piece(values, 0, values.size(), [&](std::span<const double> piece, std::size_t) {
    dead = dead && std::all_of(piece.begin(), piece.end(), [](double value) { return std::isnan(value); });
  });
  return dead;
}

// Of a row, for who is told of it.
double told_time_s(const LongTable& table, std::size_t row) {
  return table.origin.told(SeriesView(table.time_s).at(row));
}

// All axes of the sensor together: what turns one shakes the others. Of a file written by denoise the raw
// rates. note: what the reader should know of turns that stay in.
Rest rest_of(const std::string& name, const LongTable& table, const TimePart::Rows& rows,
             const SampleClock& clock, const AllanOptions& options, std::string& note) {
  std::vector<SeriesView> axes, references;
  std::string signal, axis;
  for (const LongColumn& column : table.columns) {
    const SeriesView values = SeriesView(column.values).part(rows.begin, rows.end);
    if (axis_of(column.name, "reference_rate", axis))
      references.push_back(values);
    else if (signal_of(column.name, signal, axis) && (signal == "rate" || signal == "raw") &&
             !is_dead(values))
      axes.push_back(values);
  }
  Rest all;
  all.samples = rows.end - rows.begin;
  all.at_rest = {{0, all.samples}};
  if (options.keep_motion || axes.empty()) return all;
  if (options.minus_reference) {
    // Against a reference the sensor may turn.
    const std::size_t turned = find_rest(axes, references, clock.period_s).turned;
    if (turned > 0)
      note =
          "turned in " + number(static_cast<double>(turned) * clock.period_s) +
          " s: beside the reference the scale factor's error is left, which is no noise; ifog diagnose takes "
          "it out";
    return all;
  }
  Rest rest = find_rest(axes, references, clock.period_s);
  try {
    require_rest(rest, clock.period_s, told_time_s(table, rows.begin));
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(
        name + ": " + error.what() + (references.empty() ? "" : ", or --minus-reference") +
        ", or --moving keep" +
        (references.empty() ? "" : "; a sensor turned beside a reference is for ifog diagnose"));
  }
  note = slow_turns_in_words(rest, clock.period_s, told_time_s(table, rows.begin));
  return rest;
}

// A rate as it was logged: its name in the file, when its rows were taken, and where the sensor rested.
// time_s: since the origin.
struct LoggedRate {
  const std::string& capture;
  std::string column;
  const TimeOrigin& origin;
  const SeriesView& time_s;
  const SeriesView& rate;
  const SampleClock& clock;
  const Gaps& gaps;

  [[nodiscard]] double told_time_s(std::size_t row) const { return origin.told(time_s.at(row)); }
};

// What is said of holes and of uneven stamps. Throws std::runtime_error where holes are to be refused.
void note_holes(const LoggedRate& logged, bool refuse, AllanRecord& record) {
  const SampleClock& clock = logged.clock;
  const Gaps& gaps = logged.gaps;
  const auto note = [&](std::size_t row, const std::string& what) {
    if (refuse) throw std::runtime_error(gaps.place(row) + ": " + what + ", expected none");
    record.notes.push_back(gaps.place(row) + ": " + what);
  };
  std::size_t nans = 0, first_nan = 0;
  for_each_piece(logged.rate, 0, logged.rate.size(), [&](std::span<const double> values, std::size_t first) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::isnan(values[i]) && nans++ == 0) first_nan = first + i;
  });
  record.missing = nans + clock.missing;
  if (clock.gaps > 0)
    note(clock.first_gap, std::to_string(clock.gaps) + (clock.gaps == 1 ? " gap" : " gaps") +
                              " in the time column (" + std::to_string(clock.missing) +
                              " samples missing), the first after " +
                              told_time(logged.told_time_s(clock.first_gap)) + " s");
  if (nans > 0)
    note(first_nan, missing_in_words(logged.column, nans, logged.rate.size(), logged.told_time_s(first_nan)));
  if (clock.worst_jitter_s > 0.1 * clock.period_s)
    record.notes.push_back(
        logged.capture + ": time is uneven by up to " + number(clock.worst_jitter_s * 1e3) +
        " ms; taken as jitter of the stamps of an even clock of " + number(record.sample_rate_hz) + " Hz");
}

// The deviations with their intervals, and the noise that they show.
void measure(const LoggedRate& logged, const AngleSum& sum, const AllanOptions& options, double period,
             AllanRecord& record) {
  const std::string& name = logged.capture;
  // A quarter of the longest stretch: beyond, a handful of differences decide.
  const std::vector<std::size_t> m =
      options.tau_s.empty() ? log_spaced(std::max<std::size_t>(1, record.longest / 4), options.per_decade)
                            : asked_multiples(name, options, period, record.longest);
  try {
    record.fit = noise_coefficients(sum, period);
  } catch (const std::invalid_argument& error) {
    record.notes.push_back(name + ": " + logged.column + ": no coefficients: " + error.what());
  }
  const TermVariances noise = record.fit ? record.fit->variances : TermVariances{};
  record.points = deviation(sum, m, options.kind);
  record.intervals = allan_intervals(sum, options.kind, record.points, noise, options.confidence);
  // What a bias that comes back is at each τ.
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
  for (std::size_t i = 0; i < options.tau_s.size(); ++i)
    if (std::abs(record.tau_s[i] / options.tau_s[i] - 1.0) > 1e-6)
      record.notes.push_back(name + ": --tau " + number(options.tau_s[i]) +
                             " s is no multiple of the sample time, taken at " + number(record.tau_s[i]) +
                             " s");
  record.trusted_tau_s = trusted_tau(sum, noise, options.kind, period);
}

AllanRecord analyse(const LoggedRate& logged, const std::string& signal, const std::string& axis,
                    const Rest& rest, const AllanOptions& options) {
  const std::string &name = logged.capture, &column = logged.column;
  AllanRecord record;
  record.capture = name;
  record.axis = axis;
  record.signal = signal;
  record.sample_rate_hz = rounded_rate(logged.clock.period_s);
  record.worst_jitter_s = logged.clock.worst_jitter_s;
  record.gaps = logged.clock.gaps;
  const double period = 1.0 / record.sample_rate_hz;
  note_holes(logged, options.refuse_gaps, record);

  const std::vector<Stretch> parts =
      common(stretches(logged.time_s, logged.rate, logged.clock), rest.at_rest);
  if (parts.empty()) throw std::runtime_error(name + ": " + column + " has no values");
  const AngleSum sum(logged.rate, parts);
  record.samples = sum.samples();
  record.longest = sum.longest();
  record.mean_radps = sum.mean_radps();
  if (record.longest < 2)
    throw std::runtime_error(name + ": " + column +
                             " has no two samples in a row, expected a record without so many gaps");
  if (parts.size() > 1)
    record.notes.push_back(name + ": " + column + " is analysed in " + std::to_string(parts.size()) +
                           " stretches; averages never reach across a hole, the longest stretch is " +
                           number(static_cast<double>(record.longest) * period) + " s");

  const auto told_time_s = [&](std::size_t row) { return logged.told_time_s(row); };
  // A filter leaps of itself, by its gain; what the logger did is in the raw rate beside it.
  if (const std::string leaps =
          signal == "denoised" ? "" : in_words(find_glitches(logged.rate, parts), told_time_s);
      !leaps.empty())
    record.notes.push_back(name + ": " + column + ": " + leaps);
  measure(logged, sum, options, period, record);
  record.noise_changes = noise_changes(logged.rate, parts, period, told_time_s);
  if (const std::string change = in_words(record.noise_changes); !change.empty())
    record.notes.push_back(name + ": " + column + ": " + change);
  if (record.fit) note_what_was_left_out(column, record);
  return record;
}

[[noreturn]] void refuse_header_of(const LongTable& table, const std::string& name) {
  std::vector<std::string> all{"time_s"};
  all.insert(all.end(), table.header.begin(), table.header.end());
  refuse_header(name, table.header_line,
                "no rate column, expected 'rate_radps', 'rate_x_radps', … or those of `ifog denoise`", all);
}

LongSeries less_reference(const std::string& name, const LongTable& table, const SeriesView& rate,
                          const std::string& axis) {
  const std::string wanted = axis.empty() ? "reference_rate_radps" : "reference_rate_" + axis + "_radps";
  const auto column = std::find_if(table.columns.begin(), table.columns.end(),
                                   [&](const LongColumn& c) { return c.name == wanted; });
  if (column == table.columns.end())
    throw std::runtime_error(name + ": no column " + wanted + ", expected one for --minus-reference");
  const SeriesView reference = column->values;
  LongSeries error;
  std::vector<double> room;
  for_each_piece(rate, 0, rate.size(), [&](std::span<const double> values, std::size_t first) {
    const std::span<const double> there = reference.piece(first, values.size(), room);
    for (std::size_t i = 0; i < values.size(); ++i) error.add(values[i] - there[i]);
  });
  return error;
}

// Rows of the table, from its first on, in which a denoised rate is the compensated one; 0 for other signals
// and where it never is another.
std::size_t start_of_filter(const LongTable& table, const LongColumn& column, const std::string& signal,
                            const std::string& axis) {
  if (signal != "denoised") return 0;
  const std::string wanted = "compensated" + (axis.empty() ? "" : "_" + axis) + "_radps";
  for (const LongColumn& other : table.columns) {
    if (other.name != wanted) continue;
    const std::size_t same = rows_before_the_filter(column.values, other.values);
    return same < table.size() ? same : 0;
  }
  return 0;
}

}  // namespace

std::string AllanRecord::label() const {
  return signal == "rate" ? axis : axis.empty() ? signal : signal + " " + axis;
}

bool allan_wants(const std::string& column) {
  std::string signal, axis;
  return signal_of(column, signal, axis) || axis_of(column, "reference_rate", axis);
}

std::vector<AllanRecord> allan_records(const std::string& name, const LongTable& table,
                                       const AllanOptions& options) {
  const TimePart::Rows rows = options.part.rows(table.time_s, table.origin, name);
  const SeriesView time_s = SeriesView(table.time_s).part(rows.begin, rows.end);
  if (time_s.size() < 3)
    throw std::runtime_error(name + ": " + std::to_string(time_s.size()) + " samples, expected at least 3");
  SampleClock clock;
  try {
    clock = sample_clock(time_s);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
  const Gaps gaps(name, table, rows.begin);
  std::string slow_turns;
  const Rest rest = rest_of(name, table, rows, clock, options, slow_turns);
  std::vector<AllanRecord> records;
  std::string signal, axis;
  std::vector<std::string> axes, left_out;
  bool has_axis = false;
  for (const LongColumn& column : table.columns) {
    if (!signal_of(column.name, signal, axis)) continue;
    if (std::find(axes.begin(), axes.end(), axis) == axes.end()) axes.push_back(axis);
    if (!options.axis.empty() && axis != options.axis) continue;
    has_axis = true;
    SeriesView rate = column.values;
    if (is_dead(rate.part(rows.begin, rows.end))) {
      left_out.push_back(axis.empty() ? signal : signal + "_" + axis);
      continue;
    }
    LongSeries error;
    if (options.minus_reference && signal == "rate") {
      error = less_reference(name, table, rate, axis);
      rate = error;
      signal = "error";
    }
    // A part that ends before the filter has started has nothing else to show.
    const std::size_t started = start_of_filter(table, column, signal, axis);
    const bool later = started > rows.begin && started < rows.end;
    const std::vector<Stretch> running = {{later ? started - rows.begin : 0, rows.end - rows.begin}};
    Rest analysed = rest;
    analysed.at_rest = common(rest.at_rest, running);
    const SeriesView part = rate.part(rows.begin, rows.end);
    const LoggedRate logged{
        name, signal + (axis.empty() ? "" : "_" + axis), table.origin, time_s, part, clock, gaps};
    records.push_back(analyse(logged, signal, axis, analysed, options));
    if (later)
      records.back().notes.push_back(
          name + ": " + column.name + ": until " + told_time(told_time_s(table, started)) +
          " s the filter had not started and this is the compensated rate: left out");
    if (const std::string motion = in_words(rest, clock.period_s, told_time_s(table, rows.begin));
        !motion.empty())
      records.back().notes.push_back(name + ": " + motion + "; only the rest is analysed");
    if (!slow_turns.empty()) records.back().notes.push_back(name + ": " + slow_turns);
  }
  if (axes.empty()) refuse_header_of(table, name);
  if (records.empty() && !options.axis.empty() && !has_axis)
    throw std::runtime_error(name + ": --axis is " + in_quotes(options.axis) + ", expected " +
                             expected_axes(axes));
  if (records.empty()) refuse_without_rates(name, time_s.size());
  for (const std::string& dead : left_out) tell_left_out(name, dead, time_s.size());
  return records;
}

}  // namespace ifog::tools

#include "tools/ifog/allan/allan_record.h"
#include "filters/units/field_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <utility>

#include "drivers/ifog/quoted.h"

namespace ifog::tools {
namespace {

constexpr double kTrustedDegrees = 8.0;  // relative error of the deviation 1/√(2·8), a quarter

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

// A period from time stamps carries their rounding; nine digits are more than any crystal keeps.
double rounded_rate(double period_s) {
  const double rate = 1.0 / period_s;
  const double unit = std::pow(10.0, std::floor(std::log10(rate)) - 8.0);
  return std::round(rate / unit) * unit;
}

// "rate_x_radps" → signal "rate", axis "x"; of a denoised file "raw_x_radps" and so on.
bool signal_of(const std::string& column, std::string& signal, std::string& axis) {
  constexpr std::string_view kUnit = "_radps";
  for (const char* prefix : {"rate", "raw", "compensated", "denoised"}) {
    const std::string start = prefix;
    if (!column.starts_with(start) || !column.ends_with(kUnit)) continue;
    if (column.size() < start.size() + kUnit.size()) continue;
    const std::string middle = column.substr(start.size(), column.size() - start.size() - kUnit.size());
    if (!middle.empty() &&
        (middle.size() < 2 || middle[0] != '_' || middle.find('_', 1) != std::string::npos))
      continue;
    signal = start;
    axis = middle.empty() ? "" : middle.substr(1);
    return true;
  }
  return false;
}

void cut(Table& table, const AllanOptions& options, std::size_t& first_row) {
  if (options.from_s == 0.0 && options.to_s == 0.0) return;
  const auto begin = std::lower_bound(table.time_s.begin(), table.time_s.end(), options.from_s);
  const auto end =
      options.to_s > 0.0 ? std::lower_bound(begin, table.time_s.end(), options.to_s) : table.time_s.end();
  const auto low = begin - table.time_s.begin(), high = end - table.time_s.begin();
  first_row = static_cast<std::size_t>(low);
  const auto keep = [&](std::vector<double>& v) {
    v = std::vector<double>(v.begin() + low, v.begin() + high);
  };
  keep(table.time_s);
  for (CaptureColumn& column : table.columns) keep(column.values);
}

std::vector<std::size_t> asked_multiples(const std::string& name, const AllanOptions& options, double period,
                                         std::size_t samples) {
  std::vector<std::size_t> m;
  for (const double tau : options.tau_s) {
    const double exact = tau / period;
    const auto whole = static_cast<std::size_t>(std::max(1.0, std::round(exact)));
    const std::size_t most = samples / 2;
    if (exact < 0.5 || whole > most)
      throw std::runtime_error(name + ": --tau " + number(tau) + " s is outside the record, expected " +
                               number(period) + " to " + number(static_cast<double>(most) * period) + " s");
    m.push_back(whole);
  }
  return m;
}

// Intervals want ascending τ; the points keep the order that was asked for.
std::vector<AllanInterval> intervals_in_order(const AngleSum& sum, const std::vector<DeviationPoint>& points,
                                              double confidence) {
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return points[a].m < points[b].m; });
  std::vector<DeviationPoint> sorted;
  sorted.reserve(order.size());
  for (const std::size_t i : order) sorted.push_back(points[i]);
  const auto found = allan_intervals(sum, sorted, confidence);
  std::vector<AllanInterval> out(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) out[order[i]] = found[i];
  return out;
}

double trusted_tau(const AngleSum& sum, double period) {
  std::vector<DeviationPoint> octaves;
  for (std::size_t m = 1; 2 * m <= sum.longest(); m *= 2) octaves.push_back({m, 1, 1.0});
  double trusted = 0.0;
  const auto intervals = allan_intervals(sum, octaves, 0.683);
  for (std::size_t i = 0; i < octaves.size(); ++i)
    if (intervals[i].degrees >= kTrustedDegrees) trusted = static_cast<double>(octaves[i].m) * period;
  return trusted;
}

// Where a row stands in its file: "file:line", or the sample's number where the file is no text.
class Gaps {
 public:
  Gaps(std::string file, const Table& table, std::size_t first_row)
      : file_(std::move(file)), first_row_(first_row) {
    lines_.header_line = table.header_line;
    lines_.skipped = table.skipped;
  }
  [[nodiscard]] std::string place(std::size_t row) const {
    const std::size_t line = line_of_row(lines_, row + first_row_);
    return line > 0 ? file_ + ":" + std::to_string(line)
                    : file_ + ": sample " + std::to_string(row + first_row_);
  }

 private:
  std::string file_;
  Table lines_;  // without its columns
  std::size_t first_row_;
};

AllanRecord analyse(const std::string& name, const std::string& signal, const std::string& axis,
                    std::span<const double> time_s, std::vector<double> rate, const SampleClock& clock,
                    const Gaps& gaps, const AllanOptions& options) {
  AllanRecord record;
  record.capture = name;
  record.axis = axis;
  record.signal = signal;
  record.sample_rate_hz = rounded_rate(clock.period_s);
  record.worst_jitter_s = clock.worst_jitter_s;
  record.gaps = clock.gaps;
  const double period = 1.0 / record.sample_rate_hz;
  const std::string column = signal + (axis.empty() ? "" : "_" + axis);

  std::size_t nans = 0, first_nan = 0;
  for (std::size_t i = 0; i < rate.size(); ++i)
    if (std::isnan(rate[i]) && nans++ == 0) first_nan = i;
  record.missing = nans + clock.missing;
  if (clock.gaps > 0) {
    const std::string what = std::to_string(clock.gaps) + (clock.gaps == 1 ? " gap" : " gaps") +
                             " in the time column (" + std::to_string(clock.missing) +
                             " samples missing), the first after " + number(time_s[clock.first_gap]) + " s";
    if (options.refuse_gaps)
      throw std::runtime_error(gaps.place(clock.first_gap) + ": " + what + ", expected none");
    record.notes.push_back(gaps.place(clock.first_gap) + ": " + what);
  }
  if (nans > 0) {
    const std::string what = column + " is missing in " + std::to_string(nans) +
                             (nans == 1 ? " row" : " rows") + ", first at " + number(time_s[first_nan]) +
                             " s";
    if (options.refuse_gaps)
      throw std::runtime_error(gaps.place(first_nan) + ": " + what + ", expected none");
    record.notes.push_back(gaps.place(first_nan) + ": " + what);
  }
  if (clock.worst_jitter_s > 0.1 * clock.period_s)
    record.notes.push_back(name + ": time is uneven by up to " + number(clock.worst_jitter_s * 1e3) +
                           " ms; taken as jitter of the stamps of an even clock of " +
                           number(record.sample_rate_hz) + " Hz");

  const std::vector<Stretch> parts = stretches(time_s, rate, clock);
  if (parts.empty()) throw std::runtime_error(name + ": " + column + " has no values");
  const AngleSum sum(std::move(rate), parts);
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

  // A quarter of the longest stretch: beyond, a handful of differences decide.
  const std::vector<std::size_t> m =
      options.tau_s.empty() ? log_spaced(std::max<std::size_t>(1, record.longest / 4), options.per_decade)
                            : asked_multiples(name, options, period, record.longest);
  record.points = deviation(sum, m, options.kind);
  record.intervals = intervals_in_order(sum, record.points, options.confidence);
  for (const std::size_t k : m) record.tau_s.push_back(static_cast<double>(k) / record.sample_rate_hz);
  for (std::size_t i = 0; i < options.tau_s.size(); ++i)
    if (std::abs(record.tau_s[i] / options.tau_s[i] - 1.0) > 1e-6)
      record.notes.push_back(name + ": --tau " + number(options.tau_s[i]) +
                             " s is no multiple of the sample time, taken at " + number(record.tau_s[i]) +
                             " s");
  record.trusted_tau_s = trusted_tau(sum, period);
  try {
    record.fit = fit_noise(sum, period);
  } catch (const std::invalid_argument& error) {
    record.notes.push_back(name + ": " + column + ": no coefficients: " + error.what());
  }
  if (record.fit && !record.fit->left_out_tau_s.empty()) {
    std::string taus;
    for (const double tau : record.fit->left_out_tau_s) taus += (taus.empty() ? "" : ", ") + number(tau);
    record.notes.push_back(name + ": " + column +
                           ": left out of the fit, because no sum of the terms comes near: τ " + taus +
                           " s (a line, vibration or a filter)");
  }
  if (record.fit && record.fit->misfit > 0.0)
    record.notes.push_back(name + ": " + column + ": the five terms miss the curve by " +
                           number(100.0 * record.fit->misfit) +
                           " % beyond chance (lines, filters, temperature?); the error bars allow for it");
  return record;
}

}  // namespace

std::string AllanRecord::label() const {
  return signal == "rate" ? axis : axis.empty() ? signal : signal + " " + axis;
}

std::vector<AllanRecord> allan_records(const std::string& name, Table table, const AllanOptions& options) {
  std::size_t first_row = 0;
  cut(table, options, first_row);
  if (table.time_s.size() < 3)
    throw std::runtime_error(name + ": " + std::to_string(table.time_s.size()) +
                             " samples, expected at least 3");
  SampleClock clock;
  try {
    clock = sample_clock(table.time_s);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
  const Gaps gaps(name, table, first_row);
  std::vector<AllanRecord> records;
  std::string signal, axis, known;
  for (CaptureColumn& column : table.columns) {
    if (!signal_of(column.name, signal, axis)) continue;
    known += (known.empty() ? "" : ", ") + (axis.empty() ? "(none)" : axis);
    if (!options.axis.empty() && axis != options.axis) continue;
    if (options.minus_reference && signal == "rate") {
      const std::string wanted = axis.empty() ? "reference_rate_radps" : "reference_rate_" + axis + "_radps";
      const auto reference = std::find_if(table.columns.begin(), table.columns.end(),
                                          [&](const CaptureColumn& c) { return c.name == wanted; });
      if (reference == table.columns.end())
        throw std::runtime_error(name + ": no column " + wanted + ", expected one for --minus-reference");
      for (std::size_t i = 0; i < column.values.size(); ++i) column.values[i] -= reference->values[i];
      signal = "error";
    }
    records.push_back(
        analyse(name, signal, axis, table.time_s, std::move(column.values), clock, gaps, options));
  }
  if (known.empty())
    throw std::runtime_error(
        name + ": no rate column, expected 'rate_radps', 'rate_x_radps', … or those of `ifog denoise`");
  if (records.empty())
    throw std::runtime_error(name + ": no axis " + in_quotes(options.axis) + ", expected one of " + known);
  return records;
}

const std::vector<NamedCoefficient>& named_coefficients() {
  static const std::vector<NamedCoefficient> kNamed{
      {"Q", "quantisation", "rad", "arcsec", 1.0 / kArcsecond, &NoiseFit::Q},
      {"N", "angle random walk", "rad/s/√Hz", "°/√h", 1.0 / kDegreePerRootHour, &NoiseFit::N},
      {"B", "bias instability", "rad/s", "°/h", 1.0 / kDegreePerHour, &NoiseFit::B},
      {"K", "rate random walk", "rad/s²/√Hz", "°/h/√h", 1.0 / kDegreePerHourPerRootHour, &NoiseFit::K},
      {"R", "rate ramp", "rad/s²", "°/h/h", 1.0 / kDegreePerHourPerHour, &NoiseFit::R}};
  return kNamed;
}

}  // namespace ifog::tools

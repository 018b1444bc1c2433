// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/reference_delay.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "filters/allan/stretches.h"
#include "filters/diagnosis/cleaning/autoregression.h"
#include "filters/diagnosis/cleaning/series_fit.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/linear/fourier.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::size_t kMostDelaySteps = 1U << 17U;  // steps of the series on which the delay is searched
constexpr std::size_t kLeast = 200;                 // fewest steps
constexpr int kRounds = 40;
constexpr double kSettled = 1e-5;       // in steps
constexpr double kCertainDelay = 25.0;  // required gain of twice the log-likelihood beyond the number of lags
constexpr Eigen::Index kPowers = 4;     // powers of the reference: constant to cubic
constexpr double kAccuracy = 0.1;       // in steps; sufficient accuracy of the delay
// The fourth difference of a jump is six times the jump; that of white noise has 8.4 standard deviations.
constexpr double kJumpOfFourth = 50.0;  // standard deviations of the noise, i.e. a jump of eight
constexpr std::size_t kRings = 12;      // samples on either side: half the width of the interpolation
constexpr double kMostOfJumps = 0.25;
// Limit of the ratio of fourth to second difference: small for smooth motion, two to six at a jump or kink.
constexpr double kRoughness = 1.0;

struct Pair {
  Eigen::VectorXd rate, reference;      // NaN: missing
  Eigen::VectorXd without_jumps;        // the reference; empty: has no jumps
  std::vector<Eigen::VectorXd> others;  // references of the other axes, with the same delay
  double step_s = 0.0;
};

Eigen::VectorXd vector_of(std::span<const double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

std::span<const double> values_of(const Eigen::VectorXd& series) {
  return {series.data(), static_cast<std::size_t>(series.size())};
}

Eigen::VectorXd differences(const Eigen::VectorXd& series) {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(series.size(), std::nan(""));
  out.tail(series.size() - 1) = series.tail(series.size() - 1) - series.head(series.size() - 1);
  return out;
}

std::optional<Pair> pair_of(const Record& record) {
  if (record.reference_radps.empty() || record.time_s.size() < kLeast) return std::nullopt;
  Pair pair;
  try {
    const double period_s = sample_clock(record.time_s).period_s;
    if (period_s > kSlowest_s) return std::nullopt;
    const Samples rate = on_even_grid(record, period_s, record.rate_radps);
    const std::size_t count = (rate.size() + kMostDelaySteps - 1) / kMostDelaySteps;
    const auto means = [&](std::span<const double> series) { return vector_of(means_over(series, count)); };
    pair.rate = means(rate);
    Samples reference = on_even_grid(record, period_s, record.reference_radps);
    pair.reference = means(reference);
    if (leave_out_jumps(reference, rate) > 0) pair.without_jumps = means(reference);
    for (const std::span<const double> other : record.other_references)
      if (!other.empty() && variance_of(other) > 0.0)
        pair.others.push_back(means(on_even_grid(record, period_s, other)));
    pair.step_s = period_s * static_cast<double>(count);
  } catch (const std::invalid_argument&) {
    return std::nullopt;  // no even clock, or too few samples
  }
  return pair;
}

std::size_t longest_lag(const Pair& pair) {
  return std::min(static_cast<std::size_t>(kMostEarly_s / pair.step_s),
                  static_cast<std::size_t>(pair.rate.size()) / 4);
}

std::vector<std::complex<double>> transform(const Eigen::VectorXd& series, std::size_t size) {
  std::vector<double> padded(size, 0.0);
  for (Eigen::Index i = 0; i < series.size(); ++i)
    if (std::isfinite(series[i])) padded[static_cast<std::size_t>(i)] = series[i];
  std::vector<std::complex<double>> spectrum;
  Fourier().forward(spectrum, padded);
  return spectrum;
}

// In whole steps, by the cross-correlation of the series, whitened by the sum of their spectra: its peaks of at least half
// the greatest size, from the nearest to no delay to the greatest. By the rate's spectrum alone, the noise of a reference
// differentiated from angles would hide the motion.
std::vector<std::ptrdiff_t> coarse_delays(const Pair& pair) {
  const Eigen::VectorXd rate = differences(pair.rate), reference = differences(pair.reference);
  Eigen::VectorXd both(rate.size() + reference.size());
  both << rate, reference;
  const Autoregression noise(both);
  const auto most = static_cast<std::ptrdiff_t>(longest_lag(pair));
  const std::size_t size = std::bit_ceil(static_cast<std::size_t>(rate.size() + most + 1));
  std::vector<std::complex<double>> product = transform(noise.whitened(rate), size);
  const std::vector<std::complex<double>> other = transform(noise.whitened(reference), size);
  for (std::size_t i = 0; i < product.size(); ++i) product[i] = std::conj(product[i]) * other[i];
  std::vector<double> likeness;
  Fourier().inverse(likeness, product);
  const auto at = [&](std::ptrdiff_t lag) {
    return std::abs(
        likeness[static_cast<std::size_t>(lag < 0 ? lag + static_cast<std::ptrdiff_t>(size) : lag)]);
  };
  std::ptrdiff_t greatest = 0;
  for (std::ptrdiff_t lag = -most; lag <= most; ++lag)
    if (at(lag) > at(greatest)) greatest = lag;
  std::vector<std::ptrdiff_t> peaks;
  for (std::ptrdiff_t lag = std::abs(greatest) - 1; lag > -std::abs(greatest); --lag)
    if (at(lag) >= 0.5 * at(greatest) && at(lag) >= std::max(at(lag - 1), at(lag + 1))) peaks.push_back(lag);
  std::ranges::stable_sort(peaks, {}, [](std::ptrdiff_t lag) { return std::abs(lag); });
  peaks.push_back(greatest);
  return peaks;
}

// Columns: rate, powers of the shifted reference, the other axes' references (misalignment, which in coning
// resembles the slope), and last the slope over a step.
Columns columns_of(const Pair& pair, double scale, double steps) {
  constexpr double kAside = 0.25;
  const auto at = [&](const Eigen::VectorXd& series, double to) {
    return vector_of(shifted(values_of(series), to));
  };
  Columns columns(pair.rate.size(), 2 + kPowers + static_cast<Eigen::Index>(pair.others.size()));
  const Eigen::ArrayXd moved = at(pair.reference, steps).array() / scale;
  columns.col(0) = pair.rate;
  columns.col(1) = moved.isFinite().select(Eigen::ArrayXd::Ones(moved.size()), moved);
  Eigen::Index last = 1;
  for (; last < kPowers; ++last) columns.col(last + 1) = columns.col(last).array() * moved;
  for (const Eigen::VectorXd& other : pair.others) columns.col(++last) = at(other, steps);
  columns.col(++last) =
      (at(pair.reference, steps + kAside) - at(pair.reference, steps - kAside)) / (2.0 * kAside);
  return columns;
}

// Autoregression of the noise next to the reference in `columns`, whose last is the slope.
Autoregression noise_about(const Columns& columns) {
  const Columns without = columns.leftCols(columns.cols() - 1);
  const SeriesFit fit = least_squares(without, complete_rows(without));
  return Autoregression(without.col(0) - without.rightCols(without.cols() - 1) * fit.coefficients);
}

// Harmonics of the turned angle, which over an arc resemble the slope.
Columns once_a_turn(const Pair& pair) {
  Columns columns(pair.reference.size(), 2);
  double angle = 0.0;
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    if (std::isfinite(pair.reference[i])) angle += pair.reference[i] * pair.step_s;
    columns.row(i) << std::cos(angle), std::sin(angle);
  }
  return columns;
}

struct Delay {
  double steps = 0.0, error = 0.0;
  double gain = 0.0;  // of twice the log-likelihood over no delay
  double left = 0.0;  // mean square of the whitened residual
};

// Compares the delay with none and with the harmonics of the turned angle; nullopt if these explain more.
std::optional<Delay> weighed(const Pair& pair, double scale, const Autoregression& noise, Delay delay) {
  const auto at = [&](double steps) {
    const Columns columns = columns_of(pair, scale, steps);
    return noise.whitened(columns.leftCols(columns.cols() - 1));
  };
  // Interpolation attenuates noise near half the sample rate, and the mirrored shift does so alike.
  const Columns late = at(delay.steps), logged = at(0.0), mirrored = at(-delay.steps);
  Columns turned(logged.rows(), logged.cols() + 2);
  turned << logged, noise.whitened(once_a_turn(pair));
  Columns all(logged.rows(), 3 * logged.cols());
  all << late, logged, mirrored;
  const std::vector<Eigen::Index> rows = complete_rows(all);
  const double square = least_squares(late, rows).square;
  if (least_squares(turned, rows).square < square) return std::nullopt;
  const double without = std::min(least_squares(logged, rows).square, least_squares(mirrored, rows).square);
  delay.gain = static_cast<double>(rows.size()) * std::log(without / square);
  delay.left = square / static_cast<double>(rows.size());
  return delay;
}

std::optional<Delay> refined(const Pair& pair, double steps) {
  const double scale = std::sqrt(variance_of(values_of(pair.reference)));
  if (!(scale > 0.0)) return std::nullopt;
  Delay delay;
  delay.steps = steps;
  double low = -HUGE_VAL, high = HUGE_VAL, reach = 0.5, last = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const Columns columns = columns_of(pair, scale, delay.steps);
    const Autoregression noise = noise_about(columns);
    const Columns white = noise.whitened(columns);
    const std::vector<Eigen::Index> rows = complete_rows(white);
    if (rows.size() < kLeast) return std::nullopt;
    const SeriesFit fit = least_squares(white, rows);
    const double of_reference = fit.coefficients[1] / scale;
    const double step = fit.coefficients[fit.coefficients.size() - 1] / of_reference;
    if (!std::isfinite(step)) return std::nullopt;
    delay.error = std::sqrt(fit.last_variance) / std::abs(of_reference);
    if (std::abs(step) < std::max(kSettled, 0.01 * delay.error)) return weighed(pair, scale, noise, delay);
    // The reference's noise makes the steps too short: they grow while their sign stays, between known bounds.
    (step > 0.0 ? low : high) = delay.steps;
    reach = std::max(1.0, std::exchange(last, step) * step < 0.0 ? 0.5 * reach : 2.0 * reach);
    delay.steps += std::clamp(reach * step, -1.0, 1.0);
    if (!(delay.steps > low && delay.steps < high)) delay.steps = 0.5 * (low + high);
    if (std::abs(delay.steps) > static_cast<double>(longest_lag(pair))) return std::nullopt;
  }
  return std::nullopt;
}

// A motion that repeats has a delay in each of its periods, and if it is like its mirror image in each half of them with
// the sign reversed. The nearest of eight is taken that does not fit worse by 5 %.
std::optional<Delay> likeliest_delay(const Pair& pair) {
  const std::vector<std::ptrdiff_t> peaks = coarse_delays(pair);
  const std::optional<Delay> best = refined(pair, static_cast<double>(peaks.back()));
  for (std::size_t i = 0; i + 1 < peaks.size() && i < 8; ++i) {
    const std::optional<Delay> near = refined(pair, static_cast<double>(peaks[i]));
    if (near && (!best || near->left < 1.05 * best->left)) return near;
  }
  return best;
}

// Gain of twice the log-likelihood by chance with the lags tried, plus the required margin.
double price_of(const Pair& pair) {
  return kCertainDelay + 2.0 * std::log(2.0 * static_cast<double>(longest_lag(pair)) + 1.0);
}

// Jumps give the delay only in whole samples but dominate the likelihood. If the samples without jumps
// determine it to a fraction, their result is used.
void settle_without_jumps(Pair& pair, Delay& delay) {
  if (pair.without_jumps.size() == 0) return;
  Pair smooth = pair;
  smooth.reference = pair.without_jumps;
  const std::optional<Delay> between = refined(smooth, delay.steps);
  if (!between || !(between->error < kAccuracy) || std::abs(between->steps - delay.steps) > 2.0) return;
  delay.steps = between->steps;
  delay.error = between->error;
  pair.reference = pair.without_jumps;
}

// The reference without delay, by row of the record.
Samples moved_reference(const Record& record, double delay_s) {
  const double period_s = sample_clock(record.time_s).period_s;
  const Samples logged = on_even_grid(record, period_s, record.reference_radps);
  const Samples even = shifted(logged, delay_s / period_s);
  Samples out(record.time_s.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto k =
        static_cast<std::size_t>(std::floor((record.time_s[i] - record.time_s.front()) / period_s + 0.5));
    out[i] = even[std::min(k, even.size() - 1)];
  }
  return out;
}

std::string in_words(const ReferenceDelay& delay, const std::string& name) {
  const double late = delay.delay_s;
  return name + formatted(" logged %.4g s %s (+-%.2g): shifted", std::abs(late),
                          late > 0.0 ? "late" : "early, or the rate late", delay.std_error_s);
}

}  // namespace

OwnedRecords align_references(OwnedRecords given) {
  for (Record& record : given.records) {
    std::optional<Pair> pair = pair_of(record);
    if (!pair || !(variance_of(values_of(pair->reference)) > 0.0)) continue;
    std::optional<Delay> delay = likeliest_delay(*pair);
    if (!delay || delay->gain < price_of(*pair)) continue;
    settle_without_jumps(*pair, *delay);
    ReferenceDelay found{record.name, delay->steps * pair->step_s, delay->error * pair->step_s};
    Samples& moved = given.columns.emplace_back(moved_reference(record, found.delay_s));
    const std::size_t jumps = leave_out_jumps(moved, record.rate_radps);
    record.reference_radps = moved;
    given.remarks.push_back(in_words(found, record.reference_name + given.of_several(record)));
    if (jumps > 0) given.remarks.back() += "; " + std::to_string(jumps) + " sample(s) dropped where it jumps";
    given.delays.push_back(std::move(found));
  }
  return given;
}

std::size_t leave_out_jumps(Samples& reference, std::span<const double> rate) {
  const std::size_t n = reference.size();
  Record pair;
  pair.rate_radps = rate;
  pair.reference_radps = reference;
  const double noise = std::sqrt(2.0 * white_variance({pair}));
  if (n < 5 || !(noise > 0.0)) return 0;
  std::vector<std::uint8_t> out(n, 0);
  const Samples& x = reference;
  for (std::size_t i = 2; i + 2 < n; ++i) {
    const double fourth = std::abs(x[i - 2] - 4.0 * x[i - 1] + 6.0 * x[i] - 4.0 * x[i + 1] + x[i + 2]);
    if (!(fourth > kJumpOfFourth * noise)) continue;
    double second = 0.0;
    for (std::size_t k = i - 1; k <= i + 1; ++k)
      second = std::max(second, std::abs(x[k - 1] - 2.0 * x[k] + x[k + 1]));
    if (fourth < kRoughness * second) continue;
    std::fill(out.begin() + static_cast<std::ptrdiff_t>(i < kRings ? 0 : i - kRings),
              out.begin() + static_cast<std::ptrdiff_t>(std::min(n, i + kRings + 1)), std::uint8_t{1});
  }
  const auto count = static_cast<std::size_t>(std::count(out.begin(), out.end(), std::uint8_t{1}));
  if (static_cast<double>(count) > kMostOfJumps * static_cast<double>(n)) return 0;
  for (std::size_t i = 0; i < n; ++i)
    if (out[i]) reference[i] = std::nan("");
  return count;
}

namespace {

constexpr int kHalf = 12;
using Kernel = std::array<double, 2 * kHalf>;  // of the steps -kHalf + 1 … kHalf

Kernel kernel_at(double fraction) {
  Kernel kernel{};
  double sum = 0.0;
  for (int k = 0; k < 2 * kHalf; ++k) {
    const double x = fraction - static_cast<double>(k - kHalf + 1);
    const double angle = std::numbers::pi * x;
    const double sinc = std::abs(x) < 1e-12 ? 1.0 : std::sin(angle) / angle;
    const double window = std::abs(x) < kHalf ? 0.5 + 0.5 * std::cos(angle / kHalf) : 0.0;
    kernel[static_cast<std::size_t>(k)] = sinc * window;
    sum += kernel[static_cast<std::size_t>(k)];
  }
  for (double& weight : kernel) weight /= sum;  // preserves a constant
  return kernel;
}

double value_at(std::span<const double> values, std::ptrdiff_t i) {
  return i >= 0 && i < static_cast<std::ptrdiff_t>(values.size()) ? values[static_cast<std::size_t>(i)]
                                                                  : std::numeric_limits<double>::quiet_NaN();
}

double between(std::span<const double> values, std::ptrdiff_t here, double fraction, const Kernel& kernel) {
  double sum = std::numeric_limits<double>::quiet_NaN();
  if (here >= kHalf - 1 && here + kHalf < static_cast<std::ptrdiff_t>(values.size())) {
    const double* const first = values.data() + (here - kHalf + 1);
    sum = 0.0;
    for (std::size_t k = 0; k < kernel.size(); ++k) sum += kernel[k] * first[k];
  }
  if (!std::isnan(sum)) return sum;
  if (fraction == 0.0) return value_at(values, here);
  return (1.0 - fraction) * value_at(values, here) + fraction * value_at(values, here + 1);
}

}  // namespace

Samples shifted(std::span<const double> values, double steps) {
  const double whole = std::floor(steps);
  const double fraction = steps - whole;
  const Kernel kernel = kernel_at(fraction);
  Samples out(values.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = between(values, static_cast<std::ptrdiff_t>(i) + static_cast<std::ptrdiff_t>(whole), fraction,
                     kernel);
  return out;
}

}  // namespace ifog

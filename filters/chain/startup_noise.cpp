#include "filters/chain/startup_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace ifog {
namespace {

// Keeps the gain of a record that shows no random walk above zero: then the filter averages over some 30 000
// samples.
constexpr double kLeastRatio = 1e-9;
// A sensor that repeats one value shows no noise at all; below any gyro's, above underflow in the filter.
constexpr double kLeastVariance = 1e-24;
constexpr std::size_t kOctaves = 24;
constexpr std::size_t kLeastTerms = 8;  // averages an octave must have

double allan_variance(const std::vector<double>& sum, std::size_t m) {
  const std::size_t terms = sum.size() - 2 * m;
  double total = 0.0;
  for (std::size_t i = 0; i < terms; ++i) {
    const double difference = (sum[i + 2 * m] - 2.0 * sum[i + m] + sum[i]) / static_cast<double>(m);
    total += difference * difference;
  }
  return total / (2.0 * static_cast<double>(terms));
}

struct Fit {
  double white = 0.0, walk = 0.0;
};

// Weighted least squares of y = white * a + walk * b; a term that comes out negative is absent.
Fit fit(const std::array<double, kOctaves>& y, const std::array<double, kOctaves>& a,
        const std::array<double, kOctaves>& b, const std::array<double, kOctaves>& weight,
        std::size_t count) {
  double aa = 0, ab = 0, bb = 0, ay = 0, by = 0;
  for (std::size_t k = 0; k < count; ++k) {
    aa += weight[k] * a[k] * a[k];
    ab += weight[k] * a[k] * b[k];
    bb += weight[k] * b[k] * b[k];
    ay += weight[k] * a[k] * y[k];
    by += weight[k] * b[k] * y[k];
  }
  const double determinant = aa * bb - ab * ab;
  Fit out;
  if (determinant > 1e-12 * aa * bb)
    out = {(ay * bb - by * ab) / determinant, (by * aa - ay * ab) / determinant};
  if (determinant <= 1e-12 * aa * bb || out.walk < 0.0) out = {ay / aa, 0.0};
  if (out.white < 0.0) out = {0.0, by / bb};
  return out;
}

}  // namespace

StartupNoise startup_noise(std::span<const double> rates, int axes, double period_s) {
  const std::size_t n = rates.size() / static_cast<std::size_t>(axes);
  std::array<double, kOctaves> y{}, a{}, b{}, weight{};
  std::size_t count = 0;
  std::vector<double> sum(n + 1, 0.0);
  for (int axis = 0; axis < axes; ++axis) {
    const auto rate = rates.subspan(static_cast<std::size_t>(axis) * n, n);
    double held = 0.0;
    for (const double value : rate)
      if (std::isfinite(value)) {
        held = value;
        break;
      }
    const double offset = held;  // a constant rate would cost the small differences their digits
    for (std::size_t i = 0; i < n; ++i) {
      if (std::isfinite(rate[i])) held = rate[i];
      sum[i + 1] = sum[i] + (held - offset);
    }
    count = 0;
    for (std::size_t m = 1; count < kOctaves && n >= kLeastTerms * m; m *= 2, ++count)
      y[count] += allan_variance(sum, m) / static_cast<double>(axes);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const double m = static_cast<double>(std::size_t{1} << k);
    a[k] = 1.0 / m;
    b[k] = period_s * (2.0 * m * m + 1.0) / (6.0 * m);
  }
  // The spread of an Allan variance is proportional to its value: weights from the fit before, starting at
  // the data.
  Fit found;
  for (int round = 0; round < 4; ++round) {
    for (std::size_t k = 0; k < count; ++k) {
      const double expected = round == 0 ? y[k] : found.white * a[k] + found.walk * b[k];
      const double m = static_cast<double>(std::size_t{1} << k);
      weight[k] = 1.0 / (m * std::max(expected * expected, kLeastVariance * kLeastVariance));
    }
    found = fit(y, a, b, weight, count);
  }
  StartupNoise out;
  out.measurement_noise = std::max(found.white, kLeastVariance);
  out.process_noise = std::max(found.walk, kLeastRatio * out.measurement_noise / period_s);
  return out;
}

}  // namespace ifog

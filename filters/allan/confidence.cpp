#include "filters/allan/confidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ifog {
namespace {

// The handbook asks for 30. With 30 white noise is taken for another type in one record of six, and for phase
// noise, whose degrees of freedom at long τ are a hundred times more, in one of twelve; with 100 in one of a
// hundred.
constexpr std::size_t kAveragesNeeded = 100;

double lag1(const std::vector<double>& z) {
  double mean = 0.0;
  for (const double v : z) mean += v;
  mean /= static_cast<double>(z.size());
  double c0 = 0.0, c1 = 0.0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    c0 += (z[i] - mean) * (z[i] - mean);
    if (i + 1 < z.size()) c1 += (z[i] - mean) * (z[i + 1] - mean);
  }
  return c0 > 0.0 ? c1 / c0 : 0.0;
}

// Regularised lower incomplete gamma function P(a, x): series below a + 1, Lentz's continued fraction above.
double gamma_p(double a, double x) {
  if (x <= 0.0) return 0.0;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1.0) {
    double term = 1.0 / a, sum = term;
    for (double n = a + 1.0; std::abs(term) > 1e-17 * sum; n += 1.0) {
      term *= x / n;
      sum += term;
    }
    return front * sum;
  }
  constexpr double kTiny = 1e-300;
  double b = x + 1.0 - a, c = 1.0 / kTiny, d = 1.0 / b, h = d;
  for (int i = 1; i < 100'000; ++i) {
    const double an = -i * (i - a);
    b += 2.0;
    d = an * d + b;
    if (std::abs(d) < kTiny) d = kTiny;
    c = b + an / c;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1.0 / d;
    h *= d * c;
    if (std::abs(d * c - 1.0) < 1e-16) break;
  }
  return 1.0 - front * h;
}

}  // namespace

NoiseType noise_type(const AngleSum& sum, std::size_t m, NoiseType otherwise) {
  const auto longest = std::max_element(sum.parts().begin(), sum.parts().end(),
                                        [](const auto& a, const auto& b) { return a.angles < b.angles; });
  if (longest == sum.parts().end() || (longest->angles - 1) / m < kAveragesNeeded) return otherwise;
  const double* x = sum.angle().data() + longest->first;
  // A hundred thousand averages settle the type; more would only cost time at small m.
  const std::size_t averages = std::min<std::size_t>((longest->angles - 1) / m, 100'000);
  std::vector<double> z(averages);
  for (std::size_t i = 0; i < averages; ++i) z[i] = x[(i + 1) * m] - x[i * m];
  int differences = 0;
  for (;;) {
    const double r = lag1(z);
    const double delta = r / (1.0 + r);
    if (delta < 0.25 || differences == 2) {
      const auto alpha = static_cast<int>(std::lround(-2.0 * (delta + differences)));
      return static_cast<NoiseType>(std::clamp(alpha, -2, 2));
    }
    for (std::size_t i = 0; i + 1 < z.size(); ++i) z[i] = z[i + 1] - z[i];
    z.pop_back();
    ++differences;
  }
}

double allan_degrees_of_freedom(NoiseType type, std::size_t samples, std::size_t averaged) {
  const double n = static_cast<double>(samples) + 1.0;  // angles
  const double m = static_cast<double>(averaged);
  double degrees = 1.0;
  switch (type) {
    case NoiseType::kQuantisation:
      degrees = (n + 1.0) * (n - 2.0 * m) / (2.0 * (n - m));
      break;
    case NoiseType::kFlickerPhase:
      degrees = std::exp(std::sqrt(
          std::max(0.0, std::log((n - 1.0) / (2.0 * m)) * std::log((2.0 * m + 1.0) * (n - 1.0) / 4.0))));
      break;
    case NoiseType::kAngleRandomWalk:
      degrees = (3.0 * (n - 1.0) / (2.0 * m) - 2.0 * (n - 2.0) / n) * 4.0 * m * m / (4.0 * m * m + 5.0);
      break;
    case NoiseType::kBiasInstability:
      degrees = averaged == 1 ? 2.0 * (n - 2.0) * (n - 2.0) / (2.3 * n - 4.9)
                              : 5.0 * n * n / (4.0 * m * (n + 3.0 * m));
      break;
    case NoiseType::kRateRandomWalk:
      degrees = (n - 2.0) / m * ((n - 1.0) * (n - 1.0) - 3.0 * m * (n - 1.0) + 4.0 * m * m) /
                ((n - 3.0) * (n - 3.0));
      break;
  }
  return std::isfinite(degrees) ? std::max(1.0, degrees) : 1.0;
}

double chi_squared_quantile(double p, double degrees) {
  const double a = 0.5 * degrees;
  // Bisection in the logarithm is slow but cannot fail, and there are only a few hundred calls.
  double low = -700.0, high = std::log(2.0 * a + 40.0 * std::sqrt(a) + 100.0);
  for (int i = 0; i < 200 && high - low > 1e-13 * std::max(1.0, std::abs(high)); ++i) {
    const double middle = 0.5 * (low + high);
    (gamma_p(a, std::exp(middle)) < p ? low : high) = middle;
  }
  return 2.0 * std::exp(0.5 * (low + high));
}

std::vector<AllanInterval> allan_intervals(const AngleSum& sum, std::span<const DeviationPoint> points,
                                           double confidence) {
  std::vector<AllanInterval> intervals;
  NoiseType type = points.empty() ? NoiseType::kAngleRandomWalk
                                  : noise_type(sum, points.front().m, NoiseType::kAngleRandomWalk);
  for (const DeviationPoint& point : points) {
    AllanInterval& interval = intervals.emplace_back();
    const NoiseType found = noise_type(sum, point.m, type);
    // Averaging leaves the reddest term, so phase noise does not come back after rate noise has shown.
    if (static_cast<int>(type) > 0 || static_cast<int>(found) <= 0) type = found;
    interval.type = type;
    for (const AngleSum::Part& part : sum.parts())
      if (part.angles > 2 * point.m)
        interval.degrees += allan_degrees_of_freedom(type, part.angles - 1, point.m);
    if (point.terms == 0) {
      interval.lower_radps = interval.upper_radps = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    const double tail = 0.5 * (1.0 - confidence);
    interval.lower_radps =
        std::sqrt(interval.degrees * point.variance / chi_squared_quantile(1.0 - tail, interval.degrees));
    interval.upper_radps =
        std::sqrt(interval.degrees * point.variance / chi_squared_quantile(tail, interval.degrees));
  }
  return intervals;
}

}  // namespace ifog

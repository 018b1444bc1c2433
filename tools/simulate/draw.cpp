// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/draw.h"

#include <cmath>
#include <cstddef>

namespace ifog::simulate {
namespace {

// Separates these streams from other uses of philox with the same seed, e.g. the filter's weights.
constexpr std::uint32_t kDomain = 0x53494d55U;

template <std::size_t n>
double polynomial(const std::array<double, n>& coefficients, double x) noexcept {
  double value = coefficients[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) value = value * x + coefficients[i];
  return value;
}

}  // namespace

double plain_log(double x) noexcept {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);
  if (mantissa < 0.70710678118654752) {
    mantissa *= 2.0;
    --exponent;
  }
  // ln m = 2 artanh((m − 1)/(m + 1)); |s| < 0.172, so the 13th term is below the last bit.
  const double s = (mantissa - 1.0) / (mantissa + 1.0);
  const double s2 = s * s;
  double series = 0.0;
  for (int k = 12; k >= 0; --k) series = series * s2 + 1.0 / (2 * k + 1);
  constexpr double kLn2 = 0.69314718055994530942;
  return exponent * kLn2 + 2.0 * s * series;
}

double normal_quantile(double p) noexcept {
  static constexpr std::array<double, 8> kA{
      3.3871328727963666080e0,  1.3314166789178437745e+2, 1.9715909503065514427e+3, 1.3731693765509461125e+4,
      4.5921953931549871457e+4, 6.7265770927008700853e+4, 3.3430575583588128105e+4, 2.5090809287301226727e+3};
  static constexpr std::array<double, 8> kB{1.0,
                                            4.2313330701600911252e+1,
                                            6.8718700749205790830e+2,
                                            5.3941960214247511077e+3,
                                            2.1213794301586595867e+4,
                                            3.9307895800092710610e+4,
                                            2.8729085735721942674e+4,
                                            5.2264952788528545610e+3};
  static constexpr std::array<double, 8> kC{1.42343711074968357734e0,  4.63033784615654529590e0,
                                            5.76949722146069140550e0,  3.64784832476320460504e0,
                                            1.27045825245236838258e0,  2.41780725177450611770e-1,
                                            2.27238449892691845833e-2, 7.74545014278341407640e-4};
  static constexpr std::array<double, 8> kD{1.0,
                                            2.05319162663775882187e0,
                                            1.67638483018380384940e0,
                                            6.89767334985100004550e-1,
                                            1.48103976427480074590e-1,
                                            1.51986665636164571966e-2,
                                            5.47593808499534494600e-4,
                                            1.05075007164441684324e-9};
  static constexpr std::array<double, 8> kE{6.65790464350110377720e0,  5.46378491116411436990e0,
                                            1.78482653991729133580e0,  2.96560571828504891230e-1,
                                            2.65321895265761230930e-2, 1.24266094738807843860e-3,
                                            2.71155556874348757815e-5, 2.01033439929228813265e-7};
  static constexpr std::array<double, 8> kF{1.0,
                                            5.99832206555887937690e-1,
                                            1.36929880922735805310e-1,
                                            1.48753612908506148525e-2,
                                            7.86869131145613259100e-4,
                                            1.84631831751005468180e-5,
                                            1.42151175831644588870e-7,
                                            2.04426310338993978564e-15};
  const double q = p - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * polynomial(kA, r) / polynomial(kB, r);
  }
  const double r = std::sqrt(-plain_log(q < 0.0 ? p : 1.0 - p));
  const double value = r <= 5.0 ? polynomial(kC, r - 1.6) / polynomial(kD, r - 1.6)
                                : polynomial(kE, r - 5.0) / polynomial(kF, r - 5.0);
  return q < 0.0 ? -value : value;
}

Draw::Draw(std::uint64_t seed, std::uint32_t stream) noexcept
    : stream_(stream), key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U)} {}

std::uint64_t Draw::bits() noexcept {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const PhiloxBlock block = philox(
      {static_cast<std::uint32_t>(block_), static_cast<std::uint32_t>(block_ >> 32U), stream_, kDomain},
      key_);
  ++block_;
  spare_ = (std::uint64_t{block[3]} << 32U) | block[2];
  has_spare_ = true;
  return (std::uint64_t{block[1]} << 32U) | block[0];
}

double Draw::uniform() noexcept { return (static_cast<double>(bits() >> 12U) + 0.5) * 0x1p-52; }

double Draw::uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }

double Draw::log_uniform(double low, double high) noexcept { return low * std::pow(high / low, uniform()); }

double Draw::normal() noexcept { return normal_quantile(uniform()); }

std::uint64_t Draw::below(std::uint64_t n) noexcept {
  // Rejects the highest values, which would make small results more probable.
  const std::uint64_t limit = ~std::uint64_t{0} - ~std::uint64_t{0} % n;
  std::uint64_t value = bits();
  while (value >= limit) value = bits();
  return value % n;
}

}  // namespace ifog::simulate

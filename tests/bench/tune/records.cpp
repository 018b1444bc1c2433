// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/tune/records.h"

#include <array>
#include <cmath>
#include <complex>
#include <random>

namespace ifog::bench {
namespace {

class Source {
 public:
  explicit Source(std::uint64_t seed) : engine_(seed) {}
  double normal() { return normal_(engine_); }
  double between(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
  // Uniform on a logarithmic scale.
  double about(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

// 1 - c1 B - c2 B^2 … with roots drawn inside the unit circle.
std::vector<double> stable(Source& source, int order, double largest) {
  std::vector<std::complex<double>> poly{1.0};
  const auto times = [&poly](std::complex<double> root) {
    poly.push_back(0.0);
    for (std::size_t i = poly.size() - 1; i > 0; --i) poly[i] -= root * poly[i - 1];
  };
  int left = order;
  while (left > 0) {
    if (left >= 2 && source.between(0.0, 1.0) < 0.5) {
      const auto root = std::polar(source.between(0.4, largest), source.between(0.2, 3.0));
      times(root);
      times(std::conj(root));
      left -= 2;
    } else {
      times(source.between(0.3, largest) * (source.between(0.0, 1.0) < 0.8 ? 1.0 : -1.0));
      left -= 1;
    }
  }
  std::vector<double> c;
  for (std::size_t i = 1; i < poly.size(); ++i) c.push_back(-poly[i].real());
  return c;
}

// With this standard deviation; the start-up transient is dropped.
std::vector<double> arma(Source& source, int p, int q, double sigma, std::size_t samples) {
  const std::vector<double> phi = stable(source, p, 0.98), theta = stable(source, q, 0.7);
  constexpr std::size_t kRunUp = 2000;
  std::vector<double> e(samples + kRunUp), y(samples + kRunUp, 0.0);
  for (double& value : e) value = source.normal();
  for (std::size_t k = 0; k < y.size(); ++k) {
    y[k] = e[k];
    for (std::size_t i = 0; i < phi.size() && i < k; ++i) y[k] += phi[i] * y[k - 1 - i];
    for (std::size_t i = 0; i < theta.size() && i < k; ++i) y[k] -= theta[i] * e[k - 1 - i];
  }
  std::vector<double> out(y.begin() + kRunUp, y.end());
  double square = 0.0;
  for (const double value : out) square += value * value / static_cast<double>(samples);
  for (double& value : out) value *= sigma / std::sqrt(square);
  return out;
}

std::vector<double> gauss_markov(Source& source, double sigma, std::size_t samples) {
  const double keep = std::exp(-1.0 / source.about(5.0, 300.0));
  std::vector<double> out;
  double y = source.normal();
  for (std::size_t k = 0; k < samples; ++k) {
    out.push_back(sigma * y);
    y = keep * y + std::sqrt(1.0 - keep * keep) * source.normal();
  }
  return out;
}

}  // namespace

MadeRecord make_record(std::size_t number, std::uint64_t seed, std::size_t samples) {
  static constexpr std::array kStates{"random-walk",
                                      "random-walk + ar(1)",
                                      "random-walk + ar(2)",
                                      "random-walk + ar(3)",
                                      "random-walk + arma(2,1)",
                                      "random-walk + arma(3,2)",
                                      "random-walk + gauss-markov"};
  Source source(seed * 1000003 + number);
  const std::size_t kind = number % kStates.size();
  const double sigma = source.about(0.3, 3.0);
  std::vector<double> colour(samples, 0.0);
  if (kind >= 1 && kind <= 3) colour = arma(source, static_cast<int>(kind), 0, sigma, samples);
  if (kind == 4) colour = arma(source, 2, 1, sigma, samples);
  if (kind == 5) colour = arma(source, 3, 2, sigma, samples);
  if (kind == 6) colour = gauss_markov(source, sigma, samples);
  const double step = std::sqrt(source.about(1e-10, 1e-3));
  MadeRecord made{kStates[kind], {}};
  double level = 10.0 * source.normal();
  for (std::size_t k = 0; k < samples; ++k) {
    made.rate.push_back(level + colour[k] + source.normal());
    level += step * source.normal();
  }
  return made;
}

}  // namespace ifog::bench

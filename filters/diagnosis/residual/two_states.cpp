// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/two_states.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "filters/diagnosis/record/figures.h"

namespace ifog {
namespace {

constexpr std::size_t kMeans = 1000;
constexpr double kCertainlyTwo = 40.0;  // twice the log-likelihood, for three more parameters
constexpr double kLeastApart = 2.0;     // standard deviations of a mean between the levels
constexpr std::size_t kFewestJumps = 4;
constexpr int kRounds = 60;

double gaussian_log(double x, double variance) {
  return -0.5 * (x * x / variance + std::log(2.0 * std::numbers::pi * variance));
}

// Log-likelihood of a walk seen through white noise: a scalar Kalman filter, begun at the first value.
double walk_log_likelihood(const std::vector<double>& y, double white, double walk) {
  double sum = 0.0;
  double state = y.front();
  double variance = white;
  for (std::size_t i = 1; i < y.size(); ++i) {
    variance += walk;
    const double innovation = variance + white;
    sum += gaussian_log(y[i] - state, innovation);
    const double gain = variance / innovation;
    state += gain * (y[i] - state);
    variance *= 1.0 - gain;
  }
  return sum;
}

double best_walk(const std::vector<double>& y, double all) {
  double best = -1e300;
  for (double white = all; white > 1e-4 * all; white *= 0.85)
    for (double walk = all; walk > 1e-7 * all; walk *= 0.5)
      best = std::max(best, walk_log_likelihood(y, white, walk));
  return best;
}

struct Chain {
  std::array<double, 2> level{};
  double variance = 0.0;
  std::array<double, 2> leave{};  // chance of the next mean to be of the other state
};

struct Passed {
  double log_likelihood = 0.0;
  std::vector<std::array<double, 2>> share;  // chance of each state, all the data known
  std::array<double, 2> left{};              // expected jumps out of each
};

// Forward and backward, scaled (Rabiner 1989).
Passed pass(const std::vector<double>& y, const Chain& chain) {
  const std::size_t n = y.size();
  const auto next = [&](std::size_t from, std::size_t to) {
    return from == to ? 1.0 - chain.leave[from] : chain.leave[from];
  };
  std::vector<std::array<double, 2>> seen(n), forward(n), backward(n, {1.0, 1.0});
  std::vector<double> scale(n);
  Passed out;
  for (std::size_t i = 0; i < n; ++i) {
    std::array<double, 2> logs{};
    for (std::size_t s = 0; s < 2; ++s) logs[s] = gaussian_log(y[i] - chain.level[s], chain.variance);
    const double top = std::max(logs[0], logs[1]);
    scale[i] = 0.0;
    for (std::size_t s = 0; s < 2; ++s) {
      seen[i][s] = std::exp(logs[s] - top);
      const double prior = i == 0 ? 0.5 : forward[i - 1][0] * next(0, s) + forward[i - 1][1] * next(1, s);
      forward[i][s] = seen[i][s] * prior;
      scale[i] += forward[i][s];
    }
    scale[i] = std::max(scale[i], 1e-300);
    for (double& each : forward[i]) each /= scale[i];
    // What came before the first mean the walk is not asked for either.
    if (i > 0) out.log_likelihood += std::log(scale[i]) + top;
  }
  for (std::size_t i = n - 1; i-- > 0;)
    for (std::size_t s = 0; s < 2; ++s)
      backward[i][s] = (next(s, 0) * seen[i + 1][0] * backward[i + 1][0] +
                        next(s, 1) * seen[i + 1][1] * backward[i + 1][1]) /
                       scale[i + 1];
  out.share.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double sum = forward[i][0] * backward[i][0] + forward[i][1] * backward[i][1];
    for (std::size_t s = 0; s < 2; ++s) out.share[i][s] = forward[i][s] * backward[i][s] / sum;
    if (i + 1 == n) break;
    for (std::size_t s = 0; s < 2; ++s)
      out.left[s] +=
          forward[i][s] * next(s, 1 - s) * seen[i + 1][1 - s] * backward[i + 1][1 - s] / scale[i + 1];
  }
  return out;
}

Chain improved(const std::vector<double>& y, const Passed& passed) {
  Chain chain;
  std::array<double, 2> weight{};
  for (std::size_t i = 0; i < y.size(); ++i)
    for (std::size_t s = 0; s < 2; ++s) {
      weight[s] += passed.share[i][s];
      chain.level[s] += passed.share[i][s] * y[i];
    }
  for (std::size_t s = 0; s < 2; ++s) {
    chain.level[s] /= std::max(weight[s], 1e-12);
    chain.leave[s] = std::clamp(passed.left[s] / std::max(weight[s], 1e-12), 1e-6, 0.5);
  }
  double square = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i)
    for (std::size_t s = 0; s < 2; ++s) square += passed.share[i][s] * std::pow(y[i] - chain.level[s], 2.0);
  chain.variance = std::max(square / static_cast<double>(y.size()), 1e-300);
  return chain;
}

}  // namespace

std::optional<TwoStates> find_two_states(std::span<const double> left, double period_s) {
  const std::size_t count = std::max<std::size_t>(1, left.size() / kMeans);
  const Samples means = means_over(left, count);
  std::vector<double> y(means.begin(), means.end());
  std::erase_if(y, [](double value) { return !std::isfinite(value); });
  if (y.size() < 64) return std::nullopt;
  std::vector<double> sorted = y;
  std::sort(sorted.begin(), sorted.end());
  double mean = 0.0;
  double all = 0.0;
  for (const double value : y) mean += value / static_cast<double>(y.size());
  for (const double value : y) all += (value - mean) * (value - mean) / static_cast<double>(y.size());
  if (!(all > 0.0)) return std::nullopt;
  Chain chain;
  chain.level = {sorted[y.size() / 5], sorted[y.size() - 1 - y.size() / 5]};
  chain.variance = 0.3 * all;
  chain.leave = {0.02, 0.02};
  Passed passed = pass(y, chain);
  for (int round = 0; round < kRounds; ++round) {
    chain = improved(y, passed);
    passed = pass(y, chain);
  }
  TwoStates found;
  found.difference = chain.level[1] - chain.level[0];
  if (!(std::abs(found.difference) > kLeastApart * std::sqrt(chain.variance))) return std::nullopt;
  found.ratio = 2.0 * (passed.log_likelihood - best_walk(y, all));
  for (std::size_t i = 1; i < y.size(); ++i)
    found.jumps += (passed.share[i][0] > 0.5) != (passed.share[i - 1][0] > 0.5) ? 1 : 0;
  if (found.ratio < kCertainlyTwo || found.jumps < kFewestJumps) return std::nullopt;
  const double step_s = static_cast<double>(count) * period_s;
  found.low_s = step_s / chain.leave[0];
  found.high_s = step_s / chain.leave[1];
  return found;
}

}  // namespace ifog

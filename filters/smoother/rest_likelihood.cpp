// SPDX-License-Identifier: Apache-2.0
#include "filters/smoother/rest_likelihood.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ifog {
namespace {

constexpr int kBlock = 4;  // samples: in as many the quickest walk that is learned does not show
// Left out of an end of a stretch, blocks at most.
constexpr std::size_t kMostTrimmed = 256;
// Blocks: that something is said of, and that R is known well by.
constexpr std::size_t kLeastMeans = 64, kManyMeans = 2048;
// Lags of the walk, in blocks, below which these are too long for it.
constexpr double kLeastLag = 4.0;
// Squares of innovations at most, in variances.
constexpr double kClip = 9.0;
// Trials of the ratio of walk to noise: a factor apart, up to one that has hardly any lag.
constexpr double kTried = 1.3;
constexpr double kMostWalk = 0.25;

struct Stretches {
  std::vector<double> means;
  std::vector<std::size_t> ends;

  // Means of two, of whole pairs.
  [[nodiscard]] Stretches halved() const {
    Stretches out;
    std::size_t begin = 0;
    for (const std::size_t end : ends) {
      for (std::size_t i = begin; i + 1 < end; i += 2) out.means.push_back(0.5 * (means[i] + means[i + 1]));
      begin = end;
      out.ends.push_back(out.means.size());
    }
    return out;
  }
};

struct Trial {
  double noise = 0.0;       // of a block
  double likelihood = 0.0;  // its logarithm, of that noise
  double count = 0.0;
};

// Likelihood of a walk of `ratio` of the noise a block. noise: roughly its variance, to recognise outliers.
Trial judge(const Stretches& rest, double ratio, double noise) {
  Trial out;
  double squares = 0.0, logs = 0.0, product = 1.0;
  std::size_t begin = 0;
  for (const std::size_t end : rest.ends) {
    double level = begin < end ? rest.means[begin] : 0.0, variance = 1.0;
    for (std::size_t i = begin + 1; i < end; ++i) {
      variance += ratio;
      const double factor = variance + 1.0, most = std::sqrt(kClip * factor * noise);
      const double innovation = std::clamp(rest.means[i] - level, -most, most);
      squares += innovation * innovation / factor;
      product *= factor;
      if (product > 1e100) logs += std::log(std::exchange(product, 1.0));
      out.count += 1.0;
      level += variance / factor * innovation;
      variance /= factor;
    }
    begin = end;
  }
  logs += std::log(product);
  out.noise = squares / out.count;
  out.likelihood = -0.5 * (out.count * std::log(out.noise) + logs);
  return out;
}

// Rough variance of the noise, by differences of neighbours, which a walk does not change.
double about(const Stretches& rest) {
  std::vector<double> squares;
  std::size_t begin = 0;
  for (const std::size_t end : rest.ends) {
    for (std::size_t i = begin + 1; i < end; ++i)
      squares.push_back(std::pow(rest.means[i] - rest.means[i - 1], 2));
    begin = end;
  }
  if (squares.empty()) return 0.0;
  constexpr double kMedianSquare = 0.4549364;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return *middle / kMedianSquare;
}

struct BlockFit {
  double noise = 0.0, ratio = 0.0;
};

// The predicted variance goes with the root of the walk: the mean is taken of that.
BlockFit fit_blocks(const Stretches& rest) {
  const double n = static_cast<double>(rest.means.size());
  const double rough = about(rest);
  if (!(rough > 0.0)) return {};
  std::vector<Trial> trials;
  std::vector<double> ratios;
  double most = -std::numeric_limits<double>::infinity();
  for (double ratio = 1.0 / (n * n); ratio < kMostWalk; ratio *= kTried) {
    ratios.push_back(ratio);
    trials.push_back(judge(rest, ratio, trials.empty() ? rough : trials.back().noise));
    most = std::max(most, trials.back().likelihood);
  }
  double weights = 0.0, roots = 0.0, noise = 0.0;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const double weight = std::exp(trials[i].likelihood - most);
    weights += weight;
    roots += weight * std::sqrt(ratios[i] * trials[i].noise);
    noise += weight * trials[i].noise;
  }
  noise /= weights;
  return {noise, std::pow(roots / weights, 2) / noise};
}

}  // namespace

void RestLikelihood::take(double rate) {
  sum_ += rate;
  if (++in_block_ < kBlock) return;
  blocks_.push_back(sum_ / kBlock);
  sum_ = 0.0;
  in_block_ = 0;
}

void RestLikelihood::end(bool motion_comes) {
  sum_ = 0.0;
  in_block_ = 0;
  const std::size_t begin = ends_.empty() ? 0 : ends_.back(), length = blocks_.size() - begin;
  const std::size_t most = std::min(length / kTrim, kMostTrimmed);
  blocks_.resize(blocks_.size() - (motion_comes ? most : 0));
  const auto from = blocks_.begin() + static_cast<std::ptrdiff_t>(begin);
  if (moved_) blocks_.erase(from, from + static_cast<std::ptrdiff_t>(most));
  moved_ = true;
  if (blocks_.size() > begin) ends_.push_back(blocks_.size());
}

RestOfRecord RestLikelihood::fit(double walk) const {
  std::vector<Stretches> levels{{{blocks_.begin(), blocks_.end()}, ends_}};
  if (levels.front().means.size() < kLeastMeans) return {};
  // Each stretch has a mean that no difference is of.
  while (levels.back().means.size() >= 2 * kLeastMeans + levels.back().ends.size())
    levels.push_back(levels.back().halved());
  const auto samples = [](std::size_t level) { return std::ldexp(double{kBlock}, static_cast<int>(level)); };
  RestOfRecord out;
  for (std::size_t k = levels.size(); k-- > 0;) {
    const double block = samples(k);
    if (walk > 0.0) {
      out.walk = walk;
      out.noise = block * about(levels[k]) / 2.0;
    } else {
      const BlockFit here = fit_blocks(levels[k]);
      if (!(here.noise > 0.0)) continue;  // many short stretches
      out = {here.noise * block, here.ratio * here.noise / block};
    }
    if (out.walk * block * block * kLeastLag * kLeastLag <= out.noise) break;
  }
  if (!(out.noise > 0.0)) return {};
  // With that walk R of shorter blocks, which are many.
  for (std::size_t k = levels.size(); k-- > 0;) {
    const double block = samples(k), ratio = out.walk * block * block / out.noise;
    if (levels[k].means.size() < kManyMeans && k > 0) continue;
    if (ratio <= kMostWalk) out.noise = block * judge(levels[k], ratio, out.noise / block).noise;
    break;
  }
  return out;
}

}  // namespace ifog

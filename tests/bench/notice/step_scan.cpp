// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/notice/step_scan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/health/step_test.h"

namespace ifog::bench {
namespace {

constexpr double kLeast = 2.0;  // in standard deviations: the formula is valid for rare events

}  // namespace

StepScan::StepScan(std::vector<double> left, std::vector<Window> windows, bool either_sign)
    : left_(std::move(left)), windows_(std::move(windows)), either_sign_(either_sign) {
  for (const Window& window : windows_) {
    longest_ = std::max(longest_, window.blocks);
    double squares = 0.0, neighbours = 0.0;
    for (std::size_t i = 0; i < window.blocks; ++i) squares += left_[i] * left_[i];
    for (std::size_t i = 0; i + 1 < window.blocks; ++i) neighbours += left_[i] * left_[i + 1];
    anew_.push_back(1.0 - neighbours / squares);
    std::vector<float>& weights = weights_.emplace_back();
    for (std::size_t i = 0; i < window.blocks; ++i)
      weights.push_back(static_cast<float>(left_[i] / std::sqrt(squares)));
  }
}

// Over windows that end at each of the last `looks` innovations: the smallest false alarm rate divided by the
// window's share.
double StepScan::rarest(const std::vector<float>& innovations, std::size_t looks) const {
  double out = 1.0;
  std::vector<float> sums(looks);
  for (std::size_t w = 0; w < windows_.size(); ++w) {
    const std::vector<float>& weights = weights_[w];
    std::fill(sums.begin(), sums.end(), 0.0F);
    const float* const first = innovations.data() + (innovations.size() - looks + 1 - weights.size());
    for (std::size_t i = 0; i < weights.size(); ++i)
      for (std::size_t t = 0; t < looks; ++t) sums[t] += weights[i] * first[t + i];
    float z = 0.0F;
    for (const float sum : sums) z = std::max(z, either_sign_ ? std::abs(sum) : sum);
    out = std::min(out, exceeded_per_block(std::max<double>(z, kLeast), anew_[w]) / windows_[w].share);
  }
  return out;
}

void StepScan::watch_nothing(std::size_t blocks, std::mt19937_64& random) {
  std::normal_distribution<float> normal;
  std::vector<float> innovations(kChunk + longest_);
  for (float& each : innovations) each = normal(random);
  for (std::size_t chunk = 0; chunk < blocks / kChunk; ++chunk) {
    std::copy(innovations.end() - static_cast<std::ptrdiff_t>(longest_), innovations.end(),
              innovations.begin());
    std::generate(innovations.begin() + static_cast<std::ptrdiff_t>(longest_), innovations.end(),
                  [&] { return normal(random); });
    chunks_.push_back(rarest(innovations, kChunk));
  }
  std::sort(chunks_.begin(), chunks_.end());
}

// Alarms are a Poisson process: none in a chunk with probability exp(-rate x chunk).
double StepScan::level(double alarms_per_block) const {
  const double share = -std::expm1(-alarms_per_block * kChunk);
  return chunks_[static_cast<std::size_t>(share * static_cast<double>(chunks_.size()))];
}

double StepScan::alarms_per_block(double level) const {
  const auto with = std::lower_bound(chunks_.begin(), chunks_.end(), level) - chunks_.begin();
  return -std::log1p(-static_cast<double>(with) / static_cast<double>(chunks_.size())) / kChunk;
}

double StepScan::found(double level, std::size_t looks, bool anywhere, std::size_t trials,
                       std::mt19937_64& random) const {
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<float> innovations(longest_ + looks);
  std::size_t out = 0;
  for (std::size_t trial = 0; trial < trials; ++trial) {
    const double late = anywhere ? uniform(random) : 0.0;  // fraction of the first block
    for (float& each : innovations) each = normal(random);
    for (std::size_t i = 0; i < looks; ++i)
      innovations[longest_ + i] +=
          static_cast<float>((1.0 - late) * left_[i] + (i > 0 ? late * left_[i - 1] : 0.0));
    out += rarest(innovations, looks) < level;
  }
  return static_cast<double>(out) / static_cast<double>(trials);
}

}  // namespace ifog::bench

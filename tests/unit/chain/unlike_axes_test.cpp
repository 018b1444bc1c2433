// SPDX-License-Identifier: Apache-2.0
// Axes whose noise is 1 : 10 : 100, under a model that says so and where nobody does: each is published with
// the variance of its own error.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>

#include "filters/chain/signal_chain.h"

namespace ifog {
namespace {

constexpr double kPeriod = 0.01, kWalk = 1e-5;  // the latter over the noise, a sample
constexpr std::array<double, 3> kSigma{1e-6, 1e-5, 1e-4};
const std::vector<std::string> kNames{"x", "y", "z"};

ChainSettings unlike(bool known) {
  ChainSettings out;
  out.facts.axes = 3;
  out.facts.nominal_rate_hz = 1.0 / kPeriod;
  out.axes = kNames;
  if (!known) return out;
  Model model;
  double mean = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    model.noise[kNames[a]].N = kSigma[a] * std::sqrt(kPeriod);
    mean += kSigma[a] * kSigma[a] / 3.0;
  }
  model.filter.emplace();
  model.filter->process_noise = kWalk * mean / kPeriod;
  model.filter->measurement_noise = mean;
  out.model = std::make_shared<const Model>(model);
  return out;
}

// Mean of error^2 over the variance of each axis from sample `from` to `to`, over seeds.
Axes normalised(const ChainSettings& settings, int from, int to, unsigned seeds) {
  Axes sums{};
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    SignalChain chain(std::make_unique<ChainParts>(settings));
    Increment in;
    ChainOutput out;
    Axes walk{};
    for (int i = 0; i < to; ++i) {
      in.sequence = static_cast<std::uint64_t>(i);
      in.dt_s = kPeriod;
      in.valid_axes = 7;
      in.samples = 1;
      for (std::size_t a = 0; a < 3; ++a) {
        walk[a] += std::sqrt(kWalk) * kSigma[a] * normal(random);
        in.rate_radps[a] = walk[a] + kSigma[a] * normal(random);
        in.covered_s[a] = kPeriod;
      }
      chain.process(in, out);
      if (i < from) continue;
      for (std::size_t a = 0; a < 3; ++a)
        sums[a] += std::pow(out.estimate.denoised_radps[a] - walk[a], 2) / out.estimate.variance_rad2ps2[a] /
                   (to - from) / seeds;
    }
  }
  return sums;
}

// Settled and before the noise has been measured. Without a model, what the first seconds say of each axis' part of the
// walk is forgotten with what they said of the walk.
TEST(UnlikeAxesOfAChain, HaveTheirOwnVariance) {
  struct Row {
    const char* name;
    bool known;
    int from, to;
    unsigned seeds;
    double low, high;
  };
  for (const Row& row : {Row{"a model, settled", true, 2000, 20'000, 8, 0.6, 1.4},
                         Row{"a model, first samples", true, 5, 50, 60, 0.4, 1.6},
                         Row{"no model", false, 12'000, 30'000, 8, 0.6, 1.4}}) {
    SCOPED_TRACE(row.name);
    const Axes squares = normalised(unlike(row.known), row.from, row.to, row.seeds);
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_GT(squares[a], row.low) << kNames[a];
      EXPECT_LT(squares[a], row.high) << kNames[a];
    }
  }
}

}  // namespace
}  // namespace ifog

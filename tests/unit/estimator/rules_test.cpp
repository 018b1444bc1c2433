// SPDX-License-Identifier: Apache-2.0
// The published gain at rest against the paper's equations, by the published innovations and the random weights of the
// numbers of their samples: with P- = P + Q (10) and C the weighted average of the last N squared innovations, K = P- / C
// and P = K (C - P-).
#include "filters/estimator/estimator.h"
#include "filters/random/deviates.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace ifog::test {
namespace {

constexpr std::size_t kWindow = 1000;
constexpr double kNoise = 1e-6;  // rad/s
constexpr int kSettled = 2000;  // samples in which a covariance that begins elsewhere has become the filter's

// Largest relative difference at rest of the published gain and that of the equations.
double worst(const FilterSettings& settings, std::uint64_t seed, double walk_over_noise) {
  const Record made = record(seed, 12'000, walk_over_noise);
  Fed filter(settings);
  DeviateStream weights(settings.seed, 0, DeviateStream::Law::kExponential);
  std::deque<std::pair<double, double>> window;  // weight, squared innovation
  double p = std::sqrt(walk_over_noise), far = 0.0;
  int compared = 0;
  for (std::size_t i = 0; i < made.measured.size(); ++i) {
    const EstimatorOutput& out = filter.step({kNoise * made.measured[i]});
    const double innovation = out.innovation_radps[0] / kNoise;
    window.emplace_back(weights.at(i, 0), innovation * innovation);
    if (window.size() > kWindow) window.pop_front();
    if (window.size() < kWindow) continue;
    double sum = 0.0, weighted = 0.0;
    for (const auto& [weight, square] : window) {
      sum += weight;
      weighted += weight * square;
    }
    const double c = weighted / sum, predicted = p + walk_over_noise, gain = predicted / c;
    p = gain * (c - predicted);
    if (static_cast<int>(i) < static_cast<int>(kWindow) + kSettled ||
        (!settings.plain && (out.flags & kAtRest) == 0))
      continue;
    ++compared;
    far = std::max(far, std::abs(out.gain[0] / gain - 1.0));
  }
  EXPECT_GT(compared, 8000);
  return far;
}

FilterSettings told_quiet(double walk_over_noise) {
  return told(walk_over_noise * kNoise * kNoise, kNoise * kNoise);
}

TEST(GainAtRest, IsThatOfThePapersEquations) {
  for (const std::uint64_t seed : {41U, 42U, 43U})
    EXPECT_LT(worst(told_quiet(1e-3), seed, 1e-3), 1e-9) << seed;
  FilterSettings plain = told_quiet(1e-3);
  plain.plain = true;
  plain.window = static_cast<int>(kWindow);
  EXPECT_LT(worst(plain, 44, 1e-3), 1e-9);
}

// A part of a recording that carries the whole's sequence gives the whole's bits, once what came before the
// part is forgotten to the last bit; without the sequence it never does, as other random weights are drawn.
//
// Why not from its first sample on: what a filter remembers of the samples before the part is not in the
// part. An exponential memory of m samples forgets a difference to below the 53rd bit in 37 m, and the last
// bit is then lost to rounding within a few m more.

constexpr double kRatio = 1e-3;  // gain 0.031
constexpr double kForgotten = 45.0;

// Samples of the part up to the last that differs from the whole's, in rate, variance or gain; `samples` if
// they never come together.
int apart(const FilterSettings& settings, int samples, bool carries) {
  constexpr int kBefore = 20'000;
  const Record r = record(77, kBefore + samples, kRatio);
  Fed whole(settings), part(settings);
  if (carries) part.in.sequence = kBefore;
  const auto differ = [](double a, double b) {
    return std::bit_cast<std::uint64_t>(a) != std::bit_cast<std::uint64_t>(b);
  };
  int last = 0;
  for (int i = 0; i < kBefore + samples; ++i) {
    const Axes rate{r.measured[static_cast<std::size_t>(i)]};
    const EstimatorOutput& of_whole = whole.step(rate);
    if (i < kBefore) continue;
    const EstimatorOutput& of_part = part.step(rate);
    if (differ(of_whole.denoised_radps[0], of_part.denoised_radps[0]) ||
        differ(of_whole.variance_rad2ps2[0], of_part.variance_rad2ps2[0]) ||
        differ(of_whole.gain[0], of_part.gain[0]))
      last = i - kBefore + 1;
  }
  return last;
}

TEST(Part, OfThePapersFilterHasTheBitsOfTheWholeAfterFortyTimeConstants) {
  FilterSettings settings = told(kRatio);
  settings.plain = true;
  const int forgotten = static_cast<int>(kForgotten / 0.031);
  const int carrying = apart(settings, 10'000, true);
  EXPECT_GT(carrying, 0);
  EXPECT_LT(carrying, forgotten);
  EXPECT_EQ(apart(settings, 10'000, false), 10'000);
}

}  // namespace
}  // namespace ifog::test

namespace {

// A bank of filters at rest: whatever its weights do, nothing comes out that did not go in.

using namespace ifog::test;

// Measured noise of the kind an ADIS16405 has: a walk far below the noise, neighbours a little correlated.
constexpr double kWalk = 3e-7;

Record correlated(std::uint64_t seed, int length, double correlation) {
  Noise normal(seed);
  Record made;
  double walk = 0.0, noise = normal();
  for (int i = 0; i < length; ++i) {
    walk += std::sqrt(kWalk) * normal();
    noise = correlation * noise + std::sqrt(1 - correlation * correlation) * normal();
    made.truth.push_back(walk);
    made.measured.push_back(walk + noise);
  }
  return made;
}

ifog::FilterSettings bank(bool conserve) {
  ifog::FilterSettings settings = told(kWalk);
  settings.rule = "mmae";
  settings.conserve_angle = conserve;
  return settings;
}

// The lags of the bank's filters are up to five powers of ten apart, and the likeliest changes at rest. A
// change of lag is no rotation, so no angle is to be paid back for it.
TEST(BankAtRest, PaysNoAngleForAChangeOfWeights) {
  for (const double correlation : {0.0, 0.4}) {
    const Record record = correlated(1, 50'000, correlation);
    const Filtered kept = run(bank(true), record.measured), plain = run(bank(false), record.measured);
    double most = 0.0;
    // At the beginning it may be under way, and what it falls short of is owed.
    for (std::size_t i = 1000; i < kept.denoised.size(); ++i)
      most = std::max(most, std::abs(kept.denoised[i] - plain.denoised[i]));
    EXPECT_LT(most, 0.2) << "sigma of one sample, correlation " << correlation;
  }
}

// Neighbours in the bank hardly differ in the likelihood of a sample, so evidence has to be kept for long.
TEST(BankAtRest, IsAsQuietAsTheRightFilterInTheEnd) {
  constexpr std::size_t kLearned = 20'000;
  const std::array<std::array<double, 2>, 2> kinds{{{0.0, 1.05}, {0.17, 1.25}}};
  for (const auto& [correlation, most] : kinds) {
    const Record record = correlated(2, 200'000, correlation);
    const Filtered got = run(bank(false), record.measured);
    const double right = mean_square_error(told_the_truth(record.measured, kWalk), record.truth, kLearned);
    EXPECT_LT(mean_square_error(got.denoised, record.truth, kLearned), most * most * right)
        << "correlation " << correlation;
  }
}

// Settings that cannot work are refused by name, with the value and what was expected.

using ifog::Estimator;
using ifog::FilterSettings;

FilterSettings good() {
  FilterSettings settings;
  settings.process_noise = 1e-9;
  settings.measurement_noise = 1e-8;
  return settings;
}

TEST(EstimatorSettings, AreRefusedByNameAndValue) {
  struct Row {
    std::function<void(FilterSettings&)> change;
    const char* said;
    int axes = 1;
  };
  for (const Row& row : {
           Row{[](FilterSettings&) {}, "accepted"},
           Row{[](FilterSettings& s) { s.process_noise = 0; },
               "process_noise: 0, expected a positive spectral density in (rad/s)^2/s"},
           Row{[](FilterSettings& s) { s.process_noise = 1e308; },
               "process_noise: 1e+308, expected a number 0 ... 1e+12"},
           Row{[](FilterSettings& s) { s.measurement_noise = -1; },
               "measurement_noise: -1, expected a positive variance in (rad/s)^2"},
           Row{[](FilterSettings& s) { s.measurement_noise = 1e-308; },
               "measurement_noise: 1e-308, expected a number 1e-60 ... 1e+12, or 0"},
           Row{[](FilterSettings& s) { s.weights = "none"; },
               "weights: 'none', expected \"kept\" | \"fresh\" | \"uniform\""},
           Row{[](FilterSettings& s) { s.window = 1; }, "window: 1, expected a whole number 2 ... 100000"},
           Row{[](FilterSettings& s) { s.rule = "wizard"; }, "rule: 'wizard', expected one of ckf"},
           Row{[](FilterSettings& s) { s.state = "flat"; }, "state: 'flat', expected one of random-walk"},
           Row{[](FilterSettings&) {}, "axes: 4, expected 1 to 3", 4},
       }) {
    FilterSettings settings = good();
    row.change(settings);
    const std::string said = ifog::test::refusal([&] { Estimator(settings, row.axes, 0.01); });
    EXPECT_TRUE(said.starts_with(row.said)) << row.said << ", found " << said;
  }
}

// As loud and as quiet as is let in, over a step of half a radian a second: every rule's numbers stay
// numbers, and no variance is negative, also of a rule without a floor.
TEST(EstimatorSettings, ThatAreAcceptedGiveNumbers) {
  for (const double process : {1e-300, 1e-60, 1e-9, 1e12})
    for (const double measurement : {1e-60, 1e-8, 1e12})
      for (const char* const rule : {"ckf", "irwe-akfg", "iae", "rae", "mmae", "sage-husa", "vb"})
        for (const bool plain : {false, true}) {
          FilterSettings settings = good();
          settings.process_noise = process;
          settings.measurement_noise = measurement;
          settings.rule = rule;
          settings.plain = plain;
          settings.window = 2;
          settings.weights = "fresh";
          ifog::test::Fed filter(settings, 1, 0.005);
          filter.in.covered_s[0] = 0.005;
          for (int n = 0; n < 600; ++n) {
            const ifog::EstimatorOutput& out =
                filter.step({1e-3 * (n * 7919 % 101) + (n > 300 && n < 400 ? 0.5 : 0.0)});
            ASSERT_TRUE(std::isfinite(out.denoised_radps[0]))
                << rule << ' ' << plain << ' ' << process << ' ' << measurement << ", sample " << n;
            ASSERT_GE(out.variance_rad2ps2[0], 0.0)
                << rule << ' ' << plain << ' ' << process << ' ' << measurement << ", sample " << n;
          }
        }
}

}  // namespace

// SPDX-License-Identifier: Apache-2.0
// How often the intervals of the three deviations hold the truth, over simulated records with known
// coefficients: one term alone, or two that cross along τ.
//
// The noise is synthesised in the time domain (tools/simulate), not from the covariances of the fit.
// Quantisation is the difference of independent errors of the angle: Gaussian as in the theory, or with
// --uniform those of a counter, whose squares scatter less. Prints a Markdown table.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "filters/allan/confidence.h"
#include "filters/allan/noise/noise_coefficients.h"
#include "tools/simulate/noise.h"

namespace {

using ifog::Deviation;
using ifog::kTerms;

constexpr std::array<const char*, kTerms> kName{"Q", "N", "B", "K"};
constexpr std::array<Deviation, 3> kKinds{Deviation::kAllan, Deviation::kModified, Deviation::kHadamard};
constexpr std::array<double, 2> kConfidence{0.683, 0.95};

// Allan variance for one unit of each coefficient at m samples of one second.
double allan_of(std::size_t term, double m) {
  const std::array<double, kTerms> v{3.0 / (m * m), 1.0 / m, 2.0 * std::log(2.0) / M_PI, m / 3.0};
  return v[term];
}

struct Case {
  std::string name;
  std::array<double, kTerms> truth{};  // coefficients, for a sample time of one second
};

std::vector<Case> all_cases(std::size_t n) {
  std::vector<Case> cases;
  for (std::size_t t = 0; t < kTerms; ++t) {
    Case one{kName[t], {}};
    one.truth[t] = 1.0;
    cases.push_back(one);
  }
  for (std::size_t a = 0; a < kTerms; ++a)
    for (std::size_t b = a + 1; b < kTerms; ++b)
      for (const double power : {0.15, 0.35, 0.55, 0.75}) {
        const double m = std::round(std::pow(static_cast<double>(n), power));
        Case two{std::string(kName[a]) + " " + kName[b] + " at " + std::to_string(static_cast<int>(m)), {}};
        two.truth[a] = 1.0 / std::sqrt(allan_of(a, m));
        two.truth[b] = 1.0 / std::sqrt(allan_of(b, m));
        cases.push_back(two);
      }
  return cases;
}

std::vector<double> record_of(const Case& c, std::size_t n, std::uint64_t seed, bool uniform) {
  std::vector<double> rate =
      ifog::simulate::noise({.N = c.truth[1], .B = c.truth[2], .K = c.truth[3]}, 1.0, n, seed);
  if (c.truth[0] <= 0.0) return rate;
  ifog::simulate::Draw draw(seed, 77);
  const auto error = [&] {
    return c.truth[0] * (uniform ? std::sqrt(12.0) * (draw.uniform() - 0.5) : draw.normal());
  };
  double before = error();
  for (double& r : rate) {
    const double now = error();
    r += now - before;
    before = now;
  }
  return rate;
}

ifog::TermVariances squares_of(const Case& c) {
  ifog::TermVariances v{};
  for (std::size_t t = 0; t < kTerms; ++t) v[t] = c.truth[t] * c.truth[t];
  return v;
}

// Records whose interval holds the truth, by estimator, confidence and octave.
using Tally = std::array<std::array<std::vector<int>, 2>, 3>;

// Objects that do not depend on the record.
class Estimators {
 public:
  Estimators(const std::vector<std::size_t>& m, std::size_t samples) : samples_{samples} {
    for (const Deviation kind : kKinds)
      for (const std::size_t k : m) variances_.emplace_back(kind, k, samples_);
  }
  [[nodiscard]] std::vector<ifog::WeightedChiSquared> law(Deviation kind, std::size_t m, std::size_t i,
                                                          const ifog::TermVariances& noise) const {
    const std::size_t each = variances_.size() / kKinds.size();
    const double degrees = variances_[static_cast<std::size_t>(kind) * each + i].degrees(noise);
    return ifog::estimate_law(kind, m, samples_, noise, degrees);
  }

 private:
  std::vector<std::size_t> samples_;
  std::vector<ifog::EstimateVariance> variances_;
};

void judge_intervals(const Case& c, const ifog::AngleSum& sum, const ifog::TermVariances& noise,
                     const Estimators& estimators, const std::vector<std::size_t>& m, Tally& tally) {
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    const auto points = ifog::deviation(sum, m, kKinds[k]);
    for (auto& inside : tally[k]) inside.resize(m.size());
    for (std::size_t i = 0; i < m.size(); ++i) {
      const auto law = estimators.law(kKinds[k], m[i], i, noise);
      const double truth = std::sqrt(ifog::expected_variance(kKinds[k], squares_of(c), m[i]));
      for (std::size_t q = 0; q < kConfidence.size(); ++q) {
        const auto interval = ifog::interval_of(points[i].variance, law, kConfidence[q]);
        tally[k][q][i] += truth >= interval.lower_radps && truth <= interval.upper_radps ? 1 : 0;
      }
    }
  }
}

void print(const Case& c, const Tally& tally, int records) {
  const double n = records;
  std::printf("| %s |", c.name.c_str());
  for (std::size_t k = 0; k < kKinds.size(); ++k)
    for (std::size_t q = 0; q < kConfidence.size(); ++q) {
      const auto [low, high] = std::minmax_element(tally[k][q].begin(), tally[k][q].end());
      std::printf(" %.1f … %.1f |", 100.0 * *low / n, 100.0 * *high / n);
    }
  std::printf("\n");
  std::fflush(stdout);
}

// Over all cases.
struct Summary {
  struct Coverage {
    double lowest = 1.0, highest = 0.0, sum = 0.0, octaves = 0.0, far = 0.0;  // far: by more than 4 points
  };
  std::array<Coverage, 2> coverage;

  void add(const Tally& tally, int records) {
    for (const auto& estimator : tally)
      for (std::size_t q = 0; q < kConfidence.size(); ++q)
        for (const int inside : estimator[q]) {
          const double share = static_cast<double>(inside) / records;
          Coverage& all = coverage[q];
          all.lowest = std::min(all.lowest, share);
          all.highest = std::max(all.highest, share);
          all.sum += share;
          all.octaves += 1.0;
          all.far += std::abs(share - kConfidence[q]) > 0.04 ? 1.0 : 0.0;
        }
  }

  void print() const {
    std::printf("\n");
    for (std::size_t q = 0; q < kConfidence.size(); ++q)
      std::printf(
          "%g %% intervals: mean %.1f %%, over all cases, estimators and octaves %.1f … %.1f %%; %.0f of "
          "%.0f off by more than 4 points.\n",
          100.0 * kConfidence[q], 100.0 * coverage[q].sum / coverage[q].octaves, 100.0 * coverage[q].lowest,
          100.0 * coverage[q].highest, coverage[q].far, coverage[q].octaves);
  }
};

}  // namespace

int main(int argc, char** argv) {
  int records = 1000;
  std::size_t n = 4096;
  std::uint64_t seed = 1;
  bool uniform = false;
  CLI::App app{"Coverage of the intervals of the deviations"};
  app.add_option("--records", records, "Simulated records a case")->capture_default_str();
  app.add_option("--samples", n, "Of a record")->capture_default_str();
  app.add_option("--seed", seed, "First seed")->capture_default_str();
  app.add_flag("--uniform", uniform, "Quantisation errors of a counter");
  CLI11_PARSE(app, argc, argv);

  std::vector<std::size_t> m;
  for (std::size_t k = 1; 4 * k <= n; k *= 2) m.push_back(k);
  std::printf(
      "%d records a case of %zu samples; coverage in %% over octaves of m from 1 to n/4, lowest … "
      "highest.\n\n",
      records, n);
  std::printf("| noise | Allan 68.3 | 95 | modified 68.3 | 95 | Hadamard 68.3 | 95 |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  const Estimators estimators(m, n);
  Summary all_cases_together;
  for (const Case& c : all_cases(n)) {
    Tally tally;
    for (int i = 0; i < records; ++i) {
      const std::vector<double> rate = record_of(c, n, seed + static_cast<std::uint64_t>(i), uniform);
      const std::vector<ifog::Stretch> all{{0, rate.size()}};
      const ifog::AngleSum sum(rate, all);
      const ifog::NoiseCoefficients found = ifog::noise_coefficients(sum, 1.0);
      judge_intervals(c, sum, found.variances, estimators, m, tally);
    }
    print(c, tally, records);
    all_cases_together.add(tally, records);
  }
  all_cases_together.print();
}

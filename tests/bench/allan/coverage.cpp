// SPDX-License-Identifier: Apache-2.0
// How often statements about a record's noise are true: intervals of the deviations, presence of terms, their
// errors and bounds, over simulated records with known coefficients: one term alone, or two that cross along
// τ.
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

struct Tally {
  std::array<std::array<std::vector<int>, 2>, 3> inside;  // by estimator, confidence, octave
  std::array<int, kTerms> present{}, bound_holds{}, absent{}, upper_holds{};
  std::array<double, kTerms> square{}, sum{};
  std::array<int, kTerms> within{};
  int ramps = 0;
};

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
    for (auto& inside : tally.inside[k]) inside.resize(m.size());
    for (std::size_t i = 0; i < m.size(); ++i) {
      const auto law = estimators.law(kKinds[k], m[i], i, noise);
      const double truth = std::sqrt(ifog::expected_variance(kKinds[k], squares_of(c), m[i]));
      for (std::size_t q = 0; q < kConfidence.size(); ++q) {
        const auto interval = ifog::interval_of(points[i].variance, law, kConfidence[q]);
        tally.inside[k][q][i] += truth >= interval.lower_radps && truth <= interval.upper_radps ? 1 : 0;
      }
    }
  }
}

void judge_terms(const Case& c, const ifog::NoiseCoefficients& found, Tally& tally) {
  const std::array<const ifog::NoiseCoefficient*, kTerms> terms{&found.Q, &found.N, &found.B, &found.K};
  tally.ramps += found.R.present ? 1 : 0;
  for (std::size_t t = 0; t < kTerms; ++t) {
    const ifog::NoiseCoefficient& term = *terms[t];
    tally.upper_holds[t] += term.upper >= c.truth[t] ? 1 : 0;
    if (!term.present) {
      ++tally.absent[t];
      tally.bound_holds[t] += term.upper >= c.truth[t] ? 1 : 0;
      continue;
    }
    ++tally.present[t];
    const double z = (term.value - c.truth[t]) / term.std_error;
    tally.sum[t] += z;
    tally.square[t] += z * z;
    tally.within[t] += std::abs(z) <= 1.0 ? 1 : 0;
  }
}

// Largest fraction of the Allan variance at any octave up to n/4.
double largest_share(const Case& c, const std::vector<std::size_t>& m, std::size_t term) {
  double share = 0.0;
  for (const std::size_t k : m) {
    double all = 0.0;
    for (std::size_t t = 0; t < kTerms; ++t)
      all += c.truth[t] * c.truth[t] * allan_of(t, static_cast<double>(k));
    share = std::max(share, c.truth[term] * c.truth[term] * allan_of(term, static_cast<double>(k)) / all);
  }
  return share;
}

void print(const Case& c, const Tally& tally, const std::vector<std::size_t>& m, int records) {
  const double n = records;
  std::printf("| %s |", c.name.c_str());
  for (std::size_t k = 0; k < kKinds.size(); ++k)
    for (std::size_t q = 0; q < kConfidence.size(); ++q) {
      const auto [low, high] = std::minmax_element(tally.inside[k][q].begin(), tally.inside[k][q].end());
      std::printf(" %.1f … %.1f |", 100.0 * *low / n, 100.0 * *high / n);
    }
  std::string terms;
  for (std::size_t t = 0; t < kTerms; ++t) {
    std::array<char, 160> text{};
    if (c.truth[t] > 0.0) {
      const double p = std::max(1, tally.present[t]), mean = tally.sum[t] / p;
      std::snprintf(text.data(), text.size(), " %s %.1f%s (z %+.2f ± %.2f, in %.0f %%; bound %d/%d)",
                    kName[t], 100.0 * tally.present[t] / n, largest_share(c, m, t) >= 0.3 ? "" : "*", mean,
                    std::sqrt(std::max(0.0, tally.square[t] / p - mean * mean)), 100.0 * tally.within[t] / p,
                    tally.bound_holds[t], tally.absent[t]);
      terms += text.data();
    }
  }
  std::string wrong;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (c.truth[t] == 0.0 && tally.present[t] > 0)
      wrong += std::string(" ") + kName[t] + " " + std::to_string(tally.present[t]);
  if (tally.ramps > 0) wrong += " R " + std::to_string(tally.ramps);
  std::printf("%s |%s |\n", terms.c_str(), wrong.empty() ? " none" : wrong.c_str());
  std::fflush(stdout);
}

// Standard deviation of error / standard error in one case.
double width_of(const Tally& tally, std::size_t term) {
  const double found = tally.present[term], mean = tally.sum[term] / found;
  return std::sqrt(std::max(0.0, tally.square[term] / found - mean * mean));
}

// Over all cases.
struct Summary {
  int should = 0, did = 0, false_chances = 0, false_terms = 0, ramps = 0, ramp_chances = 0, bounds = 0,
      held = 0, uppers = 0, uppers_held = 0, widths = 0, widths_kept = 0;
  double least_held = 1.0, narrowest = 10.0, widest = 0.0;
  struct Coverage {
    double lowest = 1.0, highest = 0.0, sum = 0.0, octaves = 0.0, far = 0.0;  // far: by more than 4 points
  };
  std::array<Coverage, 2> coverage;

  void add(const Case& c, const Tally& tally, const std::vector<std::size_t>& m, int records) {
    ramps += tally.ramps;
    ramp_chances += records;
    for (std::size_t t = 0; t < kTerms; ++t) {
      if (c.truth[t] == 0.0) {
        false_chances += records;
        false_terms += tally.present[t];
        continue;
      }
      // Only for terms above zero: nothing can be below zero.
      bounds += tally.absent[t];
      held += tally.bound_holds[t];
      uppers += records;
      uppers_held += tally.upper_holds[t];
      least_held = std::min(least_held, static_cast<double>(tally.upper_holds[t]) / records);
      // If a term is found in few records, these are the ones with too large values, so their standard errors
      // are not tested.
      if (2 * tally.present[t] >= records) {
        const double width = width_of(tally, t);
        ++widths;
        widths_kept += width >= 0.9 && width <= 1.1 ? 1 : 0;
        narrowest = std::min(narrowest, width);
        widest = std::max(widest, width);
      }
      if (largest_share(c, m, t) < 0.3) continue;
      should += records;
      did += tally.present[t];
    }
    for (const auto& estimator : tally.inside)
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
    const auto percent = [](int part, int all) { return 100.0 * part / std::max(1, all); };
    std::printf("\n");
    for (std::size_t q = 0; q < kConfidence.size(); ++q)
      std::printf(
          "%g %% intervals: mean %.1f %%, over all cases, estimators and octaves %.1f … %.1f %%; %.0f of "
          "%.0f off by more than 4 points.\n",
          100.0 * kConfidence[q], 100.0 * coverage[q].sum / coverage[q].octaves, 100.0 * coverage[q].lowest,
          100.0 * coverage[q].highest, coverage[q].far, coverage[q].octaves);
    std::printf("Terms with 30 %% of the variance at some octave found: %.1f %% of %d. ",
                percent(did, should), should);
    std::printf("False Q, N, B or K: %.2f %% of %d chances; false R: %.2f %% of %d.\n",
                percent(false_terms, false_chances), false_chances, percent(ramps, ramp_chances),
                ramp_chances);
    std::printf(
        "Bounds printed for terms that are there and not seen, at or above the truth: %.2f %% of %d. Upper "
        "limits of all terms that are there, seen or not: %.2f %% of %d, least of a case %.1f %%.\n",
        percent(held, bounds), bounds, percent(uppers_held, uppers), uppers, 100.0 * least_held);
    std::printf(
        "Width of error over error bar, by case and term seen in half of the records or more: %.2f … %.2f, "
        "within 0.9 to 1.1 in %d of %d.\n",
        narrowest, widest, widths_kept, widths);
  }
};

}  // namespace

int main(int argc, char** argv) {
  int records = 1000;
  std::size_t n = 4096;
  std::uint64_t seed = 1;
  bool uniform = false, told = false;
  std::string only;
  CLI::App app{"Coverage of intervals, presence, error bars and bounds of the noise terms"};
  app.add_option("--records", records, "Simulated records a case")->capture_default_str();
  app.add_option("--samples", n, "Of a record")->capture_default_str();
  app.add_option("--seed", seed, "First seed")->capture_default_str();
  app.add_option("--only", only, "Cases whose name starts like this");
  app.add_flag("--uniform", uniform, "Quantisation errors of a counter");
  app.add_flag("--told", told, "Only the intervals, from the true terms instead of those found");
  CLI11_PARSE(app, argc, argv);

  std::vector<std::size_t> m;
  for (std::size_t k = 1; 4 * k <= n; k *= 2) m.push_back(k);
  std::printf(
      "%d records a case of %zu samples; coverage in %% over octaves of m from 1 to n/4, lowest … "
      "highest.\n\n",
      records, n);
  std::printf(
      "| noise | Allan 68.3 | 95 | modified 68.3 | 95 | Hadamard 68.3 | 95 | found %% (error bars) | false "
      "|\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  const Estimators estimators(m, n);
  Summary all_cases_together;
  for (const Case& c : all_cases(n)) {
    if (!c.name.starts_with(only)) continue;
    Tally tally;
    for (int i = 0; i < records; ++i) {
      const std::vector<double> rate = record_of(c, n, seed + static_cast<std::uint64_t>(i), uniform);
      const std::vector<ifog::Stretch> all{{0, rate.size()}};
      const ifog::AngleSum sum(rate, all);
      if (told) {
        judge_intervals(c, sum, squares_of(c), estimators, m, tally);
        continue;
      }
      const ifog::NoiseCoefficients found = ifog::noise_coefficients(sum, 1.0);
      judge_intervals(c, sum, found.variances, estimators, m, tally);
      judge_terms(c, found, tally);
    }
    print(c, tally, m, records);
    all_cases_together.add(c, tally, m, records);
  }
  all_cases_together.print();
}

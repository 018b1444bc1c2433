// SPDX-License-Identifier: Apache-2.0
// How often a correlated bias is found without and with one in the record, and the error of its parameters.
// Prints a Markdown table. Samples of one second; white noise of one unit.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "filters/allan/noise/noise_coefficients.h"
#include "filters/diagnosis/regression/whitening.h"
#include "filters/diagnosis/report/prediction.h"
#include "tools/simulate/noise.h"

namespace {

struct Case {
  std::string name;
  ifog::simulate::NoiseLevels terms;
  double sigma = 0.0, correlation = 0.0;  // of a correlated bias; in samples
};

std::vector<double> record_of(const Case& c, std::size_t n, std::uint64_t seed) {
  std::vector<double> rate = ifog::simulate::noise(c.terms, 1.0, n, seed);
  if (c.sigma <= 0.0) return rate;
  ifog::simulate::GaussMarkov bias(c.sigma, c.correlation, 1.0, ifog::simulate::Draw(seed, 91));
  for (double& r : rate) r += bias.next();
  return rate;
}

// The law crosses the white noise at `at` samples.
ifog::simulate::NoiseLevels white_and(double at, bool flicker, bool walk) {
  ifog::simulate::NoiseLevels out{.N = 1.0};
  if (flicker) out.B = 1.0 / std::sqrt(2.0 * std::log(2.0) / M_PI * at);
  if (walk) out.K = std::sqrt(3.0) / at;
  return out;
}

ifog::NoisePosterior::Part part_of(double weight, const ifog::TermVariances& terms, double correlation) {
  const double flicker = terms[ifog::kB] * std::log(ifog::kFlickerSpacing) / M_PI;
  if (correlation > 0.0)
    return {weight, terms[ifog::kN], 0.0, flicker, 0.5 * terms[ifog::kK] * correlation, correlation};
  return {weight, terms[ifog::kN], terms[ifog::kK], flicker, 0.0, 0.0};
}

// Mean square of the heading an hour after a bias estimate of five minutes, divided by the predicted one.
double foretold(const Case& c, const ifog::NoiseCoefficients& found) {
  constexpr double kAligned_s = 300.0, kAfter_s = 3600.0;
  ifog::NoisePosterior truth, seen;
  for (double tau = 8.0; tau < 1e6; tau *= ifog::kFlickerSpacing) truth.flicker_s.push_back(tau);
  seen.flicker_s = truth.flicker_s;
  const ifog::TermVariances terms{
      0.0, c.terms.N * c.terms.N, c.terms.B * c.terms.B,
      c.sigma > 0.0 ? 2.0 * c.sigma * c.sigma / c.correlation : c.terms.K * c.terms.K};
  truth.parts.push_back(part_of(1.0, terms, c.correlation));
  if (found.markov)
    for (const auto& chance : found.markov->chances)
      seen.parts.push_back(part_of(chance.weight, chance.variances, chance.correlation));
  else
    seen.parts.push_back(part_of(1.0, found.variances, 0.0));
  return ifog::heading_variance(truth, kAligned_s, kAfter_s) /
         ifog::heading_variance(seen, kAligned_s, kAfter_s);
}

double walk_of(const Case& c) { return c.sigma > 0.0 ? c.sigma * std::sqrt(2.0 / c.correlation) : c.terms.K; }

}  // namespace

int main(int argc, char** argv) {
  std::size_t n = 7200, records = 100;
  std::string only;
  bool each = false;
  CLI::App app("How often a correlated bias is found");
  app.add_option("--samples", n, "of a record")->capture_default_str();
  app.add_option("--records", records, "of a case")->capture_default_str();
  app.add_option("--only", only, "Cases that begin so");
  app.add_flag("--each", each, "A line a record in which a return is likelier, too");
  CLI11_PARSE(app, argc, argv);
  const double length = static_cast<double>(n);
  std::vector<Case> cases{{"N", {.N = 1.0}}, {"B", {.B = 1.0}}, {"K", {.K = 1.0}}};
  for (const double part : {0.002, 0.02, 0.1}) {
    char at[32];
    std::snprintf(at, sizeof at, " at %g", part * length);
    cases.push_back({std::string("N K") + at, white_and(part * length, false, true)});
    cases.push_back({std::string("N B") + at, white_and(part * length, true, false)});
  }
  // The second is 0.003 °/√h with a bias of 0.1 °/h and 300 s in two hours.
  for (const auto& [sigma, correlation] : {std::pair{1.5, 36.0}, {0.556, 300.0}, {0.556, 720.0}}) {
    char name[64];
    std::snprintf(name, sizeof name, "N and correlated, %g", correlation);
    cases.push_back({name, {.N = 1.0}, sigma, correlation});
  }
  std::printf(
      "| noise | found | score | time inside | time found / true | sigma found / true | K mean / true | K "
      "present | weighed | heading² / foretold |\n|---|---|---|---|---|---|---|---|---|---|\n");
  const std::vector<ifog::Stretch> whole{{0, n}};
  for (const Case& c : cases) {
    if (!c.name.starts_with(only)) continue;
    std::size_t found = 0, inside = 0, present = 0, weighed = 0;
    double ratio = 0.0, score = 0.0, time = 0.0, sigma = 0.0, walk = 0.0;
    for (std::size_t r = 0; r < records; ++r) {
      const std::vector<double> rate = record_of(c, n, 1000 + r);
      const auto noise = ifog::noise_coefficients(ifog::AngleSum(rate, whole), 1.0);
      present += noise.K.present ? 1 : 0;
      walk += noise.K.value;
      weighed += noise.markov ? 1 : 0;
      if (each && noise.markov)
        std::printf("gain %.2f time %.1f (%.1f … %.1f) sigma %.3g\n", noise.markov->fit.gain,
                    noise.markov->correlation_s, noise.markov->lower_s, noise.markov->upper_s,
                    noise.markov->sigma_radps);
      ratio += foretold(c, noise);
      if (!noise.markov || !noise.markov->present) continue;
      ++found;
      score += noise.markov->score;
      time += std::log(noise.markov->correlation_s);
      sigma += std::log(noise.markov->sigma_radps);
      inside += noise.markov->lower_s <= c.correlation && c.correlation <= noise.markov->upper_s ? 1 : 0;
    }
    const double of = static_cast<double>(std::max<std::size_t>(1, found)),
                 all = static_cast<double>(records);
    std::printf(
        "| %s | %.3f | %.2f | %.3f | %.3f | %.3f | %.3f | %.3f | %.3f | %.2f |\n", c.name.c_str(),
        static_cast<double>(found) / all, score / of, static_cast<double>(inside) / of,
        c.correlation > 0 ? std::exp(time / of) / c.correlation : 0.0,
        c.sigma > 0 ? std::exp(sigma / of) / c.sigma : 0.0,
        walk_of(c) > 0.0 ? walk / std::max<double>(1.0, static_cast<double>(present)) / walk_of(c) : 0.0,
        static_cast<double>(present) / all, static_cast<double>(weighed) / all, ratio / all);
    std::fflush(stdout);
  }
  return 0;
}

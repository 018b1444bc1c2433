// SPDX-License-Identifier: Apache-2.0
// Tests if `tune` finds the maximum: compares its likelihood on simulated records with the best of fifty
// searches from random starts, and checks if BIC selects the model that made the record. Usage: tune_bench
// [RECORDS [SAMPLES [SEED]]], 200 of 3000 from seed 1.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <nlopt.hpp>
#include <random>
#include <string>
#include <vector>

#include "filters/kalman/likelihood.h"
#include "filters/state_models/state_model.h"
#include "filters/tune/candidate.h"
#include "filters/tune/tune.h"
#include "tests/bench/tune/records.h"

namespace {

constexpr int kStarts = 50;
constexpr double kWithin = 2.0;

struct Search {
  const ifog::ModelCandidate& candidate;
  const ifog::LikelihoodRecord& record;
  double scale;

  static double call(unsigned n, const double* theta, double*, void* self) {
    const auto& search = *static_cast<const Search*>(self);
    const auto s = search.candidate.settings(std::span(theta, n), search.scale);
    try {
      const auto model = ifog::make_state_model(s.state, s.state_parameters, 1.0);
      const double cost = -ifog::likelihood(*model, s.process_noise, s.measurement_noise, search.record, 1.0)
                               .log_likelihood();
      return std::isfinite(cost) ? cost : 1e300;
    } catch (const std::invalid_argument&) {
      return 1e300;
    }
  }
};

double scale_of(const std::vector<double>& rate) {
  double sum = 0.0;
  for (std::size_t k = 1; k < rate.size(); ++k) sum += (rate[k] - rate[k - 1]) * (rate[k] - rate[k - 1]);
  return std::sqrt(sum / static_cast<double>(rate.size() - 1));
}

// Largest ln L of fifty bounded searches (BOBYQA, derivative-free) from uniformly distributed starts.
double best_of_many(const ifog::bench::MadeRecord& made, std::uint64_t seed) {
  const ifog::ModelCandidate candidate(made.state, 1.0);
  const std::span<const double> axes[] = {made.rate};
  const ifog::LikelihoodRecord record(axes);
  Search objective{candidate, record, scale_of(made.rate)};
  const auto n = static_cast<std::size_t>(candidate.size());
  std::vector<double> low(n), high(n);
  candidate.bounds(low, high);
  std::mt19937_64 random(seed);
  const auto between = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  double best = -1e300;
  for (int start = 0; start < kStarts; ++start) {
    std::vector<double> theta(n);
    theta[0] = between(-25.0, 0.0);
    theta[1] = between(-5.0, 1.0);
    for (std::size_t i = 2; i < n; ++i) theta[i] = i == 2 ? between(-8.0, 1.0) : between(-2.0, 2.0);
    if (made.state == "random-walk + gauss-markov") theta[3] = between(0.0, 7.0);
    nlopt::opt search(nlopt::LN_BOBYQA, static_cast<unsigned>(n));
    search.set_lower_bounds(low);
    search.set_upper_bounds(high);
    search.set_min_objective(&Search::call, &objective);
    search.set_initial_step(1.0);
    search.set_ftol_abs(1e-4);
    search.set_maxeval(60 * static_cast<int>(n));
    double cost = 0.0;
    try {
      search.optimize(theta, cost);
    } catch (const nlopt::roundoff_limited&) {
      cost = Search::call(static_cast<unsigned>(n), theta.data(), nullptr, &objective);
    }
    best = std::max(best, -cost);
  }
  return best;
}

struct Tally {
  int records = 0, within = 0, ahead = 0, right = 0;
  double worst = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  const std::size_t records = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 200;
  const std::size_t samples = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 3000;
  const std::uint64_t seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  std::map<std::string, Tally> tallies;
  double tune_s = 0.0;
  for (std::size_t i = 0; i < records; ++i) {
    const ifog::bench::MadeRecord made = ifog::bench::make_record(i, seed, samples);
    const std::span<const double> axes[] = {made.rate};
    ifog::TuneOptions options;
    options.hold_out = false;
    options.threads = 1;
    const auto began = std::chrono::steady_clock::now();
    const ifog::Tuning tuning = ifog::tune(axes, 1.0, options);
    tune_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const auto same = std::find_if(tuning.models.begin(), tuning.models.end(),
                                   [&](const auto& m) { return m.settings.state == made.state; });
    const double behind = best_of_many(made, seed + i) - same->log_likelihood;
    Tally& tally = tallies[made.state];
    ++tally.records;
    tally.within += behind <= kWithin ? 1 : 0;
    tally.ahead += behind < -kWithin ? 1 : 0;
    tally.right += tuning.models.front().settings.state == made.state ? 1 : 0;
    tally.worst = std::max(tally.worst, behind);
    if (behind > kWithin) std::printf("record %zu, %s: %.1f behind\n", i, made.state.c_str(), behind);
    std::fflush(stdout);
  }
  Tally all;
  std::printf(
      "| made by | records | within 2 of the best of 50 | more than 2 ahead of it | worst | picked by BIC "
      "|\n");
  std::printf("|---|---|---|---|---|---|\n");
  const auto print = [](const char* name, const Tally& t) {
    std::printf("| %s | %d | %d | %d | %.1f | %d |\n", name, t.records, t.within, t.ahead, t.worst, t.right);
  };
  for (const auto& [name, t] : tallies) {
    print(name.c_str(), t);
    all.records += t.records;
    all.within += t.within;
    all.ahead += t.ahead;
    all.right += t.right;
    all.worst = std::max(all.worst, t.worst);
  }
  print("all", all);
  std::printf("\n%.2f s a record of %zu samples for all models, one thread\n",
              tune_s / static_cast<double>(records), samples);
  return all.within >= 0.95 * all.records ? 0 : 1;
}

// SPDX-License-Identifier: Apache-2.0
// Quality of every rule on every motion with correct and wrong Q and R. Figures are RMSE after the first
// thousand samples relative to a Kalman filter with true Q and R, mean over seeds with the standard deviation
// between seeds. In motion that filter lags, so values far below one are possible.
//
//   quality_bench [--seeds N] [--ratio Q/R] [--false-triggers SAMPLES]     prints markdown tables
//
// The first columns are the rules as published; "irwe-akfg + following" is the daemon's default with
// detection of manoeuvres and conservation of the angle.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "filters/estimator/estimator.h"
#include "filters/rules/rule.h"
#include "tests/bench/quality/scenarios.h"

namespace {

using ifog::bench::Record;

constexpr int kSamples = 12'000;
constexpr std::size_t kFrom = 1000;
constexpr double kPeriod = 0.01;

double rmse(const std::vector<double>& estimate, const std::vector<double>& truth, std::size_t from = kFrom) {
  double sum = 0.0;
  for (std::size_t i = from; i < truth.size(); ++i)
    sum += (estimate[i] - truth[i]) * (estimate[i] - truth[i]);
  return std::sqrt(sum / static_cast<double>(truth.size() - from));
}

struct Outcome {
  std::vector<double> denoised;
  std::vector<bool> manoeuvre;
  ifog::EstimatorHealth health;
};

Outcome run(const ifog::FilterSettings& settings, const std::vector<double>& measured) {
  ifog::Estimator estimator(settings, 1, kPeriod);
  ifog::EstimatorInput in;
  ifog::EstimatorOutput out;
  in.valid_axes = 1;
  in.dt_s = kPeriod;
  Outcome outcome;
  for (const double rate : measured) {
    in.rate_radps[0] = rate;
    estimator.step(in, out);
    ++in.sequence;
    outcome.denoised.push_back(out.denoised_radps[0]);
    outcome.manoeuvre.push_back((out.flags & ifog::kManoeuvre) != 0);
  }
  outcome.health = estimator.health();
  return outcome;
}

struct Column {
  std::string rule;
  bool following;
};

ifog::FilterSettings settings(const Column& column, double q, double r) {
  ifog::FilterSettings s;
  s.rule = column.rule;
  s.process_noise = q / kPeriod;
  s.measurement_noise = r;
  s.follow_manoeuvres = s.conserve_angle = column.following;
  return s;
}

struct Given {
  double q, r;
};

void study(double ratio, int seeds) {
  std::vector<Column> columns;
  for (const ifog::RuleEntry& rule : ifog::rules()) columns.push_back({rule.name, false});
  columns.push_back({"ckf", true});
  columns.push_back({"irwe-akfg", true});
  std::printf(
      "Q/R = %g, %d seeds. RMSE over a Kalman filter given the truth, +- standard deviation between "
      "seeds.\n\n",
      ratio, seeds);
  std::printf("| scenario | Q given | R given |");
  for (const Column& c : columns) std::printf(" %s%s |", c.rule.c_str(), c.following ? " + following" : "");
  std::printf("\n|---|---|---|");
  for (std::size_t i = 0; i < columns.size(); ++i) std::printf("---|");
  std::printf("\n");
  for (const auto& scenario : ifog::bench::scenarios()) {
    std::vector<Record> records;
    std::vector<double> reference;
    for (int seed = 1; seed <= seeds; ++seed) {
      records.push_back(
          ifog::bench::make_record(scenario, static_cast<std::uint64_t>(seed), kSamples, ratio));
      reference.push_back(
          rmse(ifog::bench::told_the_truth(records.back().measured, ratio), records.back().truth));
    }
    for (const Given& given : {Given{1, 1}, {1, 0.01}, {1, 100}, {0.01, 1}, {100, 1}}) {
      std::printf("| %s | x%g | x%g |", scenario.name, given.q, given.r);
      for (const Column& column : columns) {
        double sum = 0.0, squares = 0.0;
        for (std::size_t i = 0; i < records.size(); ++i) {
          const Outcome got = run(settings(column, ratio * given.q, given.r), records[i].measured);
          const double relative = rmse(got.denoised, records[i].truth) / reference[i];
          sum += relative;
          squares += relative * relative;
        }
        const double mean = sum / seeds;
        std::printf(" %.3f ± %.3f |", mean, std::sqrt(std::max(0.0, squares / seeds - mean * mean)));
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  }
}

// Manoeuvres detected at rest, i.e. false ones.
void false_triggers(double ratio, long samples) {
  constexpr long kRecord = 500'000;
  std::uint64_t manoeuvres = 0, gated = 0;
  long total = 0;
  for (std::uint64_t seed = 1; total < samples; ++seed, total += kRecord) {
    const Record record = ifog::bench::make_record(ifog::bench::scenarios()[0], seed + 1000, kRecord, ratio);
    const Outcome got = run(settings({"irwe-akfg", true}, ratio, 1.0), record.measured);
    manoeuvres += got.health.manoeuvres;
    gated += got.health.gated;
  }
  std::printf("\nAt rest, %ld samples: %llu manoeuvres, %llu measurements rejected as outliers.\n", total,
              static_cast<unsigned long long>(manoeuvres), static_cast<unsigned long long>(gated));
}

// The same with autocorrelated noise, after the colour is learned, and the cost of following there.
void coloured(int samples) {
  constexpr std::size_t kLearned = 20'000;
  constexpr std::uint64_t kSeeds = 4;
  std::printf(
      "\nAt rest in coloured noise, irwe-akfg + following, %llu records of %d samples, the first %zu not "
      "counted.\n\n| autocorrelation at lag 1 | Q/R | samples in manoeuvres | most in a record | RMSE over "
      "that without following |\n|---|---|---|---|---|\n",
      static_cast<unsigned long long>(kSeeds), samples, kLearned);
  for (const double correlation : {0.5, 0.8, 0.9, 0.98}) {
    for (const double ratio : {1e-3, 1e-6}) {
      double share = 0.0, most = 0.0, followed = 0.0, plain = 0.0;
      for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const Record record =
            ifog::bench::make_record(ifog::bench::scenarios()[0], seed + 2000, samples, ratio, correlation);
        const Outcome got = run(settings({"irwe-akfg", true}, ratio, 1.0), record.measured);
        const Outcome without = run(settings({"irwe-akfg", false}, ratio, 1.0), record.measured);
        const auto moving = std::count(got.manoeuvre.begin() + kLearned, got.manoeuvre.end(), true);
        const double part = static_cast<double>(moving) / (samples - static_cast<double>(kLearned));
        share += part / kSeeds;
        most = std::max(most, part);
        followed += std::pow(rmse(got.denoised, record.truth, kLearned), 2);
        plain += std::pow(rmse(without.denoised, record.truth, kLearned), 2);
      }
      std::printf("| %g | %g | %.2f %% | %.2f %% | %.3f |\n", correlation, ratio, 100 * share, 100 * most,
                  std::sqrt(followed / plain));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  int seeds = 20;
  double ratio = 1e-3;
  long samples = 3'000'000;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--seeds") == 0) {
      seeds = std::atoi(argv[i + 1]);
    } else if (std::strcmp(argv[i], "--ratio") == 0) {
      ratio = std::atof(argv[i + 1]);
    } else if (std::strcmp(argv[i], "--false-triggers") == 0) {
      samples = std::atol(argv[i + 1]);
    } else {
      seeds = 0;
    }
  }
  if (argc % 2 == 0 || seeds < 1 || !(ratio > 0) || samples < 0) {
    std::fprintf(stderr, "usage: quality_bench [--seeds N] [--ratio Q/R] [--false-triggers SAMPLES]\n");
    return 2;
  }
  study(ratio, seeds);
  if (samples > 0) false_triggers(ratio, samples);
  if (samples > 0) coloured(static_cast<int>(std::clamp(samples / 10, 50'000L, 1'000'000L)));
  return 0;
}

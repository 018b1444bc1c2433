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
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "filters/estimator/estimator.h"
#include "filters/rules/rule.h"

namespace {

constexpr int kSamples = 12'000;
constexpr std::size_t kFrom = 1000;
constexpr double kPeriod = 0.01;

// A motion in units of the measurement noise and in samples.
struct Scenario {
  const char* name;
  double (*motion)(int sample);
};

struct Record {
  std::vector<double> truth, measured;
};

constexpr int kStart = 2000;  // at rest before the motion

double still(int) { return 0.0; }
double step20(int i) { return i >= kStart ? 20.0 : 0.0; }
double step5(int i) { return i >= kStart ? 5.0 : 0.0; }
double ramp(int i) { return i < kStart ? 0.0 : 0.05 * (std::min(i, 6000) - kStart); }
double sine(int i) {
  return i < kStart ? 0.0 : 100.0 * std::sin(2 * std::numbers::pi * (i - kStart) / 2000.0);
}
double small_sine(int i) {
  return i < kStart ? 0.0 : 5.0 * std::sin(2 * std::numbers::pi * (i - kStart) / 500.0);
}

// Dwells of 1000 samples with transitions of 50 samples, because a rate table has finite acceleration.
double table(int i) {
  constexpr std::array kLevels{0.0, 300.0, -300.0, 100.0, -50.0, 20.0, -20.0, 0.0};
  if (i < kStart) return 0.0;
  const auto dwell = static_cast<std::size_t>((i - kStart) / 1000);
  const int inside = (i - kStart) % 1000;
  const double from = kLevels[dwell % kLevels.size()];
  const double to = kLevels[(dwell + 1) % kLevels.size()];
  return inside < 50 ? from + (to - from) * inside / 50.0 : to;
}

constexpr std::array kScenarios{Scenario{"static", still},    Scenario{"step 20σ", step20},
                                Scenario{"step 5σ", step5},   Scenario{"ramp", ramp},
                                Scenario{"sine 100σ", sine},  Scenario{"sine 5σ", small_sine},
                                Scenario{"rate table", table}};

// A random walk of variance `ratio` per step in white unit noise, plus the motion.
Record make_record(const Scenario& scenario, std::uint64_t seed, int samples, double ratio) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Record record;
  double walk = 0.0;
  for (int i = 0; i < samples; ++i) {
    if (i > 0) walk += std::sqrt(ratio) * normal(random);
    record.truth.push_back(walk + scenario.motion(i));
    record.measured.push_back(record.truth.back() + normal(random));
  }
  return record;
}

// The scalar Kalman filter with true Q and R, without motion, written by hand: the reference for every rule.
std::vector<double> told_the_truth(const std::vector<double>& measured, double ratio) {
  std::vector<double> out{measured[0]};
  double x = measured[0], p = 1.0;
  for (std::size_t i = 1; i < measured.size(); ++i) {
    p += ratio;
    const double gain = p / (p + 1.0);
    x += gain * (measured[i] - x);
    p *= 1.0 - gain;
    out.push_back(x);
  }
  return out;
}

double rmse(const std::vector<double>& estimate, const std::vector<double>& truth) {
  double sum = 0.0;
  for (std::size_t i = kFrom; i < truth.size(); ++i)
    sum += (estimate[i] - truth[i]) * (estimate[i] - truth[i]);
  return std::sqrt(sum / static_cast<double>(truth.size() - kFrom));
}

struct Outcome {
  std::vector<double> denoised;
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
  for (const auto& scenario : kScenarios) {
    std::vector<Record> records;
    std::vector<double> reference;
    for (int seed = 1; seed <= seeds; ++seed) {
      records.push_back(make_record(scenario, static_cast<std::uint64_t>(seed), kSamples, ratio));
      reference.push_back(rmse(told_the_truth(records.back().measured, ratio), records.back().truth));
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
    const Record record = make_record(kScenarios[0], seed + 1000, kRecord, ratio);
    const Outcome got = run(settings({"irwe-akfg", true}, ratio, 1.0), record.measured);
    manoeuvres += got.health.manoeuvres;
    gated += got.health.gated;
  }
  std::printf("\nAt rest, %ld samples: %llu manoeuvres, %llu measurements rejected as outliers.\n", total,
              static_cast<unsigned long long>(manoeuvres), static_cast<unsigned long long>(gated));
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
  return 0;
}

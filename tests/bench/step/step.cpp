// SPDX-License-Identifier: Apache-2.0
// Time of one filter step relative to a hand-written scalar Kalman step.
//
// Every candidate runs over the same record in the same process; one round runs all in turn. The figure is
// the median over rounds of the ratio within a round, so that slow periods of the machine affect both.
//
//   step_bench [rounds]     prints a markdown table; exit 1 if a target is missed
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "filters/kalman/core.h"
#include "filters/rules/rule.h"

namespace {

constexpr std::size_t kSteps = 20'000;
constexpr double kPeriod = 1e-3;
constexpr double kProcess = 1e-3, kNoise = 1.0;

std::vector<double> record() {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> z(kSteps);
  double x = 0.0;
  for (double& value : z) {
    x += std::sqrt(kProcess) * normal(random);
    value = x + normal(random);
  }
  return z;
}

// Result of a candidate, so that nothing is optimised away.
volatile double sink = 0.0;

void hand_written(const std::vector<double>& z) {
  double x = 0.0, p = 1.0;
  for (const double measured : z) {
    p += kProcess;
    const double gain = p / (p + kNoise);
    x += gain * (measured - x);
    p *= 1.0 - gain;
  }
  sink = x + p;
}

// Core and rule: the filter step of one axis.
void core_and_rule(const std::vector<double>& z, ifog::Rule& rule) {
  ifog::KalmanCore<1> core;
  core.h(0) = 1.0;
  core.p(0, 0) = 1.0;
  std::uint64_t sequence = 0;
  for (const double measured : z) {
    core.p(0, 0) += kProcess;
    const double innovation = measured - core.x(0, 0);
    core.correct(rule.innovation_covariance({core.p(0, 0), 1.0, {&innovation, 1}, sequence++, 0}));
    core.update(0, innovation);
  }
  sink = core.x(0, 0);
}

struct Candidate {
  std::string name;
  std::function<void(const std::vector<double>&)> run;
  double target;  // multiple of the hand-written step; 0: none
};

double seconds(const Candidate& candidate, const std::vector<double>& z) {
  // Processor time of this thread.
  const auto now = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  const double start = now();
  candidate.run(z);
  return now() - start;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::vector<Candidate> candidates() {
  std::vector<Candidate> all{{"hand-written scalar", hand_written, 0.0}};
  const auto add = [&](const char* name, const char* rule_name, const char* weights, double target) {
    ifog::FilterSettings settings;
    settings.rule = rule_name;
    settings.weights = weights;
    settings.process_noise = kProcess / kPeriod;
    settings.measurement_noise = kNoise;
    const std::shared_ptr<ifog::Rule> rule = ifog::make_rule(settings);
    all.push_back({name, [rule](const std::vector<double>& z) { core_and_rule(z, *rule); }, target});
  };
  add("ckf, n = 1", "ckf", "kept", 1.5);
  add("irwe-akfg, kept weights, N = 50, n = 1", "irwe-akfg", "kept", 5.0);
  add("irwe-akfg, fresh weights, N = 50, n = 1", "irwe-akfg", "fresh", 25.0);
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 31;
  if (rounds < 3) {
    std::fprintf(stderr, "step_bench: rounds: %s, expected a number of at least 3\n", argv[1]);
    return 2;
  }
  const std::vector<double> z = record();
  const std::vector<Candidate> all = candidates();
  std::vector<std::vector<double>> times(all.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < all.size(); ++i) times[i].push_back(seconds(all[i], z));
  }
  std::printf("| step | ns | x hand-written scalar | target |\n|---|---|---|---|\n");
  bool missed = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<double> scalar;
    for (int round = 0; round < rounds; ++round) {
      const auto r = static_cast<std::size_t>(round);
      scalar.push_back(times[i][r] / times[0][r]);
    }
    const double ratio = median(scalar);
    const bool late = all[i].target > 0.0 && ratio > all[i].target;
    missed = missed || late;
    char target[48] = "";
    if (all[i].target > 0.0)
      std::snprintf(target, sizeof target, "<= %.3g%s", all[i].target, late ? " MISSED" : "");
    std::printf("| %s | %.1f | %.2f | %s |\n", all[i].name.c_str(), 1e9 * median(times[i]) / kSteps, ratio,
                target);
  }
  return missed ? 1 : 0;
}

// SPDX-License-Identifier: Apache-2.0
// Time of one filter step relative to a hand-written scalar Kalman step, and to plain Eigen of the same size.
//
// Every candidate runs over the same record in the same process; one round runs all in turn. The figure is
// the median over rounds of the ratio within a round, so that slow periods of the machine affect both.
//
//   step_bench [rounds]     prints a markdown table; exit 1 if a target of the first three rows is missed
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

#include "filters/estimator/estimator.h"
#include "filters/kalman/core.h"
#include "filters/rules/rule.h"
#include "filters/state_models/state_model.h"

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

template <int n>
std::string model_name() {
  return n == 1 ? "random-walk" : (n == 2 ? "integrated-random-walk" : "ar(" + std::to_string(n) + ")");
}
template <int n>
std::vector<double> model_parameters() {
  if (n < 3) return {};
  std::vector<double> phi(n, 0.0);
  phi[0] = 0.5;
  phi[n - 1] = 0.3;
  return phi;
}

template <int n>
struct Matrices {
  Eigen::Matrix<double, n, n> transition, driving;
  Eigen::Matrix<double, n, 1> h;
  Matrices() {
    const auto model = ifog::make_state_model(model_name<n>(), model_parameters<n>(), kPeriod);
    model->discretise(kPeriod, transition, driving);
    driving *= kProcess / kPeriod;
    h = model->measurement();
  }
};

// The textbook equations with Eigen's fixed sizes.
template <int n>
void plain_eigen(const std::vector<double>& z) {
  static const Matrices<n> m;
  Eigen::Matrix<double, n, 1> x = Eigen::Matrix<double, n, 1>::Zero();
  Eigen::Matrix<double, n, n> p = Eigen::Matrix<double, n, n>::Identity();
  for (const double measured : z) {
    x = (m.transition * x).eval();
    p = (m.transition * p * m.transition.transpose()).eval() + m.driving;
    const Eigen::Matrix<double, n, 1> ph = p * m.h;
    const Eigen::Matrix<double, n, 1> gain = ph / (m.h.dot(ph) + kNoise);
    x += gain * (measured - m.h.dot(x));
    p = ((Eigen::Matrix<double, n, n>::Identity() - gain * m.h.transpose()) * p).eval();
  }
  sink = x(0) + p(0, 0);
}

template <int n>
ifog::FilterSettings settings(const std::string& rule, const std::string& weights) {
  ifog::FilterSettings s;
  s.rule = rule;
  s.weights = weights;
  s.state = model_name<n>();
  s.state_parameters = model_parameters<n>();
  s.process_noise = kProcess / kPeriod;
  s.measurement_noise = kNoise;
  return s;
}

// Core and rule: the filter step of one axis.
template <int n>
void core_and_rule(const std::vector<double>& z, ifog::Rule& rule) {
  static const Matrices<n> m;
  ifog::KalmanCore<n> core;
  core.h = m.h;
  core.p.setIdentity();
  std::uint64_t sequence = 0;
  for (const double measured : z) {
    core.x.col(0) = (m.transition * core.x.col(0)).eval();
    if constexpr (n == 1) {
      core.p(0, 0) += m.driving(0, 0);
    } else {
      core.p = (m.transition * core.p * m.transition.transpose()).eval() + m.driving;
    }
    const double innovation = measured - core.h.dot(core.x.col(0));
    core.correct(
        rule.innovation_covariance({core.h.dot(core.p * core.h), 1.0, {&innovation, 1}, sequence++, 0}));
    core.update(0, innovation);
  }
  sink = core.x(0, 0);
}

void estimator(const std::vector<double>& z, ifog::Estimator& filter, int axes) {
  ifog::EstimatorInput in;
  ifog::EstimatorOutput out;
  in.dt_s = kPeriod;
  in.valid_axes = (1U << static_cast<unsigned>(axes)) - 1U;
  for (const double measured : z) {
    in.rate_radps = {measured, measured, measured};
    filter.step(in, out);
    ++in.sequence;
  }
  sink = out.denoised_radps[0];
}

struct Candidate {
  std::string name;
  std::function<void(const std::vector<double>&)> run;
  std::size_t peer;     // index of the plain Eigen candidate of this size
  double target = 0.0;  // multiple of the hand-written step; 0: none
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

template <int n>
void add_size(std::vector<Candidate>& all) {
  const std::size_t peer = all.size();
  all.push_back({"plain Eigen, n = " + std::to_string(n), plain_eigen<n>, peer, 0.0});
  struct Row {
    const char *rule, *weights, *label;
    double target;
  };
  for (const Row& row :
       {Row{"ckf", "kept", "ckf", 1.5}, Row{"irwe-akfg", "kept", "irwe-akfg, kept weights, N = 50", 5.0},
        Row{"irwe-akfg", "fresh", "irwe-akfg, fresh weights, N = 50", 25.0}, Row{"iae", "kept", "iae", 0.0},
        Row{"rae", "kept", "rae", 0.0}, Row{"sage-husa", "kept", "sage-husa", 0.0},
        Row{"vb", "kept", "vb", 0.0}}) {
    if (n > 1 && row.target == 0.0) continue;  // the cost of a rule does not depend on the number of states
    const std::shared_ptr<ifog::Rule> rule = ifog::make_rule(settings<n>(row.rule, row.weights));
    all.push_back({std::string(row.label) + ", n = " + std::to_string(n),
                   [rule](const std::vector<double>& z) { core_and_rule<n>(z, *rule); }, peer,
                   n == 1 ? row.target : 0.0});
  }
  for (const char* rule : {"ckf", "irwe-akfg"}) {
    for (const int axes : {1, 3}) {
      const auto filter = std::make_shared<ifog::Estimator>(settings<n>(rule, "kept"), axes, kPeriod);
      all.push_back({"whole estimator, " + std::string(rule) + ", n = " + std::to_string(n) + ", axes " +
                         std::to_string(axes),
                     [filter, axes](const std::vector<double>& z) { estimator(z, *filter, axes); }, peer,
                     0.0});
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 31;
  if (rounds < 3) {
    std::fprintf(stderr, "step_bench: rounds: %s, expected a number of at least 3\n", argv[1]);
    return 2;
  }
  const std::vector<double> z = record();
  std::vector<Candidate> all{{"hand-written scalar", hand_written, 0, 0.0}};
  add_size<1>(all);
  add_size<2>(all);
  add_size<4>(all);
  add_size<8>(all);

  std::vector<std::vector<double>> times(all.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < all.size(); ++i) times[i].push_back(seconds(all[i], z));
  }
  std::printf(
      "| step | ns | x hand-written scalar | x plain Eigen of its size | target |\n|---|---|---|---|---|\n");
  bool missed = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<double> scalar, eigen;
    for (int round = 0; round < rounds; ++round) {
      const auto r = static_cast<std::size_t>(round);
      scalar.push_back(times[i][r] / times[0][r]);
      eigen.push_back(times[i][r] / times[all[i].peer][r]);
    }
    const double ratio = median(scalar);
    const bool late = all[i].target > 0.0 && ratio > all[i].target;
    missed = missed || late;
    char target[48] = "";
    if (all[i].target > 0.0)
      std::snprintf(target, sizeof target, "<= %.3g%s", all[i].target, late ? " MISSED" : "");
    std::printf("| %s | %.1f | %.2f | %.2f | %s |\n", all[i].name.c_str(), 1e9 * median(times[i]) / kSteps,
                ratio, median(eigen), target);
  }
  return missed ? 1 : 0;
}

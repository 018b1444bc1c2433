// SPDX-License-Identifier: Apache-2.0
// The longest single step of what is learned beside the filter's steps: a gyro's noise at rest, and the
// start-up estimate. Processor time of the thread, the least of seven runs for each step, so that other work
// on the machine does not count. Usage: learning_bench
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <vector>

#include "filters/estimator/rest_noise.h"
#include "filters/estimator/start_up.h"

namespace {

constexpr int kRuns = 7;

double processor_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e9 + static_cast<double>(now.tv_nsec);
}

std::vector<double> white(std::size_t samples) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  std::vector<double> out(samples);
  for (double& value : out) value = normal(engine);
  return out;
}

}  // namespace

int main() {
  const std::vector<double> rate = white(400'000);
  std::vector<double> least(rate.size(), 1e18);
  for (int run = 0; run < kRuns; ++run) {
    ifog::RestNoise learner;
    for (std::size_t i = 0; i < rate.size(); ++i) {
      const double began = processor_ns();
      learner.take({rate[i], rate[i], rate[i]}, 7, ifog::RestSample::kRest);
      (void)learner.take_news(1e-3);
      least[i] = std::min(least[i], processor_ns() - began);
    }
  }
  std::sort(least.begin(), least.end());
  std::printf(
      "noise at rest, 3 axes, a sample: median %.0f ns, 99.9 %% %.0f ns, longest %.0f ns (clock included)\n",
      least[least.size() / 2], least[least.size() * 999 / 1000], least.back());
  for (const std::size_t samples : {4'000U, 20'000U}) {
    const std::vector<double> start = white(3 * samples);
    double best = 1e18;
    for (int run = 0; run < kRuns; ++run) {
      const double began = processor_ns();
      (void)ifog::estimate_noise(start, 3, 1e-3);
      best = std::min(best, processor_ns() - began);
    }
    std::printf("start-up estimate, 3 axes of %zu samples, once: %.2f ms\n", samples, best * 1e-6);
  }
}

// SPDX-License-Identifier: Apache-2.0
// Longest single step of learning the noise at rest and of the start-up estimate. Processor time of the
// thread, minimum of seven runs for each step, so that other work does not count. Usage: learning_bench
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <vector>

#include "filters/estimator/walk.h"

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
    ifog::Walk learner;
    for (std::size_t i = 0; i < rate.size(); ++i) {
      const double began = processor_ns();
      (void)learner.take({rate[i], rate[i], rate[i]}, 7, true);
      least[i] = std::min(least[i], processor_ns() - began);
    }
  }
  std::sort(least.begin(), least.end());
  std::printf(
      "noise at rest, 3 axes, a sample: median %.0f ns, 99.9 %% %.0f ns, longest %.0f ns (clock included)\n",
      least[least.size() / 2], least[least.size() * 999 / 1000], least.back());
}

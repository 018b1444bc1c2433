// SPDX-License-Identifier: Apache-2.0
// How often a change of constant noise is reported, and how often a true change is found, by `ifog allan`,
// `tune` and `diagnose`.
//
//   noise_change_bench [--records N] [--seed FIRST]
//
// Prints two Markdown tables.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "filters/rest/noise_change.h"
#include "tools/simulate/noise.h"

namespace {

using Random = std::mt19937_64;
using Rates = std::vector<double>;
struct Kind {
  std::string name;
  std::function<Rates(std::size_t samples, std::uint64_t seed)> make;
};

Rates independent(std::size_t samples, const std::function<double()>& draw) {
  Rates out(samples);
  for (double& value : out) value = draw();
  return out;
}

Rates autoregressive(std::size_t samples, std::uint64_t seed, double first, double second) {
  Random random(seed);
  std::normal_distribution<double> normal;
  double before = 0.0, last = 0.0;
  const auto next = [&] {
    const double now = first * last + second * before + normal(random);
    before = last;
    return last = now;
  };
  for (int i = 0; i < 5000; ++i) next();
  return independent(samples, next);
}

// Two poles, correlated over `samples`.
Rates resonance(std::size_t samples, std::uint64_t seed) {
  const double pole = std::exp(-1.0 / 100.0), turn = 2.0 * std::numbers::pi * 0.03;
  return autoregressive(samples, seed, 2.0 * pole * std::cos(turn), -pole * pole);
}

Rates line_in_white(std::size_t samples, std::uint64_t seed) {
  Random random(seed);
  std::normal_distribution<double> normal;
  double i = 0.0;
  return independent(samples, [&] { return std::sin(0.0371 * i++) + normal(random); });
}

Rates student(std::size_t samples, std::uint64_t seed) {
  Random random(seed);
  std::student_t_distribution<double> student(3.0);
  return independent(samples, [&] { return student(random); });
}

Rates with_outliers(std::size_t samples, std::uint64_t seed) {
  Random random(seed);
  std::normal_distribution<double> normal;
  std::bernoulli_distribution outlier(1e-3);
  return independent(samples, [&] { return normal(random) + (outlier(random) ? 20.0 : 0.0); });
}

std::vector<Kind> kinds() {
  const auto terms = [](double N, double B, double K) {
    return [=](std::size_t samples, std::uint64_t seed) {
      return ifog::simulate::noise({.N = N, .B = B, .K = K}, 1.0, samples, seed);
    };
  };
  const auto coloured = [](double correlation) {
    return [=](std::size_t samples, std::uint64_t seed) {
      return autoregressive(samples, seed, correlation, 0.0);
    };
  };
  return {{"white", terms(1.0, 0.0, 0.0)},
          {"flicker", terms(0.0, 1.0, 0.0)},
          {"random walk", terms(0.0, 0.0, 1.0)},
          {"white, flicker and random walk", terms(1.0, 0.1, 0.01)},
          {"neighbours correlated by 0.5", coloured(0.5)},
          {"by 0.9", coloured(0.9)},
          {"by 0.98", coloured(0.98)},
          {"a resonance, of 100 samples", resonance},
          {"a line in white noise", line_in_white},
          {"Student t3", student},
          {"outliers, 0.1 % of 20 sigma", with_outliers},
          {"rounded to 1 sigma", [](std::size_t samples, std::uint64_t seed) {
             Rates out = ifog::simulate::noise({.N = 1.0, .K = 1e-3}, 1.0, samples, seed);
             for (double& value : out) value = std::nearbyint(value);
             return out;
           }}};
}

constexpr std::size_t kLengths[] = {2048, 16384, 131072};

bool found(const Rates& rate) {
  const std::vector<ifog::Stretch> all{{0, rate.size()}};
  return !ifog::noise_changes(rate, all, 1.0, [](std::size_t i) { return static_cast<double>(i); }).empty();
}

void print_false_alarms(int records, std::uint64_t seed) {
  std::printf("| noise that is the same | 2048 samples | 16384 | 131072 |\n|---|---|---|---|\n");
  for (const Kind& kind : kinds()) {
    std::printf("| %s |", kind.name.c_str());
    for (const std::size_t samples : kLengths) {
      int said = 0;
      for (int i = 0; i < records; ++i)
        said += found(kind.make(samples, seed + static_cast<std::uint64_t>(i))) ? 1 : 0;
      std::printf(" %.2f %% |", 100.0 * said / records);
      std::fflush(stdout);
    }
    std::printf("\n");
  }
}

void print_power(int records, std::uint64_t seed) {
  std::printf("\n| white noise that is louder | 2048 samples | 16384 | 131072 |\n|---|---|---|---|\n");
  for (const double share : {0.03, 0.1, 0.5})
    for (const double times : {1.5, 2.0, 5.0}) {
      std::printf("| %g times, in %g %% of the record |", times, 100.0 * share);
      for (const std::size_t samples : kLengths) {
        int said = 0;
        for (int i = 0; i < records; ++i) {
          Rates rate = ifog::simulate::noise({.N = 1.0}, 1.0, samples, seed + static_cast<std::uint64_t>(i));
          const auto length = static_cast<std::size_t>(share * static_cast<double>(samples));
          const std::size_t begin = (static_cast<std::size_t>(i) * 7919) % (samples - length);
          for (std::size_t k = begin; k < begin + length; ++k) rate[k] *= times;
          said += found(rate) ? 1 : 0;
        }
        std::printf(" %.1f %% |", 100.0 * said / records);
        std::fflush(stdout);
      }
      std::printf("\n");
    }
}

}  // namespace

int main(int argc, char** argv) {
  int records = 1000;
  std::uint64_t seed = 1;
  CLI::App app{"Noise that is the same all along, and noise that is not"};
  app.add_option("--records", records, "Simulated records a case")->capture_default_str();
  app.add_option("--seed", seed, "First seed")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  print_false_alarms(records, seed);
  print_power(std::max(1, records / 5), seed + 1'000'000);
}

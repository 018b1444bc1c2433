// SPDX-License-Identifier: Apache-2.0
// Time and memory of a diagnosis: by default one hour at 1 kHz with eight channels and three hidden effects.
// The capture is made in memory, so parsing is not included. Prints processor time, elapsed time and peak
// memory as a multiple of the capture's doubles. Exit 1 if the target of 10 s of processor time or 3 x is
// missed, or an effect.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <random>

#include "filters/diagnosis/diagnose.h"

namespace {

using Series = std::vector<double>;

constexpr double kWalkShare = 1e-4;

struct Made {
  Series time, rate;
  std::vector<std::string> names;
  std::vector<Series> channels;
};

Made make(double minutes, double rate_hz) {
  const auto n = static_cast<std::size_t>(minutes * 60.0 * rate_hz);
  Made made;
  made.names = {"temperature_degC", "accel_x_mps2",  "accel_y_mps2",  "accel_z_mps2",
                "supply_V",         "magnetic_x_uT", "magnetic_y_uT", "pressure_Pa"};
  made.channels.assign(made.names.size(), Series(n));
  made.time.resize(n);
  made.rate.resize(n);
  std::mt19937_64 random(20);
  std::normal_distribution<double> noise;
  std::vector<double> wander(made.names.size(), 0.0);
  const double span_s = minutes * 60.0;
  double walk = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    made.time[i] = t;
    for (std::size_t c = 0; c < wander.size(); ++c) {
      wander[c] += (noise(random) - 0.001 * wander[c]) / rate_hz;
      made.channels[c][i] = wander[c] + 0.01 * noise(random);
    }
    made.channels[0][i] =
        25.0 + 10.0 * std::sin(2.0 * std::numbers::pi * 2.3 * t / span_s) + 0.01 * noise(random);
    walk += kWalkShare * noise(random) / std::sqrt(rate_hz);
    // deg/h: white noise, a slow walk, temperature, acceleration, a line.
    const double error = 30.0 * noise(random) + walk + 0.2 * (made.channels[0][i] - 25.0) +
                         2.0 * made.channels[1][i] + 0.5 * std::sin(2.0 * std::numbers::pi * 3.37 * t);
    made.rate[i] = error * std::numbers::pi / 180.0 / 3600.0;
  }
  return made;
}

}  // namespace

int main(int argc, char** argv) {
  double minutes = 60.0, rate_hz = 1000.0;
  CLI::App app{"time and memory of a diagnosis"};
  app.add_option("--minutes", minutes)->check(CLI::Range(1.0, 1440.0));
  app.add_option("--rate", rate_hz, "Hz")->check(CLI::Range(1.0, 10000.0));
  std::string unused;
  app.add_option("--benchmark_min_time", unused)->group("");  // tools/test passes it to every benchmark
  CLI11_PARSE(app, argc, argv);

  const Made made = make(minutes, rate_hz);
  ifog::Record record;
  record.name = "made";
  record.time_s = made.time;
  record.rate_radps = made.rate;
  for (std::size_t c = 0; c < made.names.size(); ++c)
    record.channels.push_back({made.names[c], made.channels[c]});
  const double doubles = 8.0 * static_cast<double>(made.time.size() * (2 + made.channels.size()));

  const std::clock_t cpu = std::clock();
  const auto start = std::chrono::steady_clock::now();
  const ifog::Diagnosis diagnosis = ifog::diagnose({record}, {});
  const double cpu_s = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const double memory = 1024.0 * static_cast<double>(usage.ru_maxrss) / doubles;

  std::printf("%zu samples, %zu channels, %.0f MB of doubles\n", made.time.size(), made.channels.size(),
              doubles / 1e6);
  int temperature = 0, acceleration = 0, line = 0;
  for (const ifog::FoundEffect& found : diagnosis.effects) {
    std::printf("found %s %s\n", found.effect.form.c_str(), found.effect.channel.c_str());
    temperature += found.effect.channel == made.names[0] ? 1 : 0;
    acceleration += found.effect.channel == made.names[1] ? 1 : 0;
    line += found.effect.form == "line" ? 1 : 0;
  }
  const bool found = temperature == 1 && acceleration == 1 && line == 1 && diagnosis.effects.size() == 3;
  std::printf("processor time %.2f s (target <= 10), elapsed %.2f s\n", cpu_s, wall_s);
  std::printf("peak memory %.2f x the capture's doubles (target <= 3)\n", memory);
  return found && cpu_s <= 10.0 && memory <= 3.0 ? 0 : 1;
}

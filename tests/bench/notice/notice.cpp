// SPDX-License-Identifier: Apache-2.0
// Changes of a gyro that the daemon detects, and false alarms: many months in blocks, and the whole chain at
// its sample rate. Prints one line per case; results are in results.md.
//
// usage: notice_bench blocks MONTHS SEED [WORD]  months of each kind of noise, in blocks of ten seconds
//        notice_bench steps SENSORS SEED [WORD]  steps of the bias and more noise, after three days at rest,
//                                                in twenty continuations of each
//        notice_bench limits BLOCKS SEED [WORD]  the best possible detection for several kinds of knowledge
//        notice_bench chain DAYS SEED            a gyro at 200 Hz through signal chain and watch
// WORD: only kinds of noise with it in their name.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "daemon/health/sensor_watch.h"
#include "filters/chain/signal_chain.h"
#include "tests/bench/notice/noise_kinds.h"
#include "tests/bench/notice/slow_noise.h"
#include "tests/bench/notice/step_bound.h"
#include "tests/bench/notice/step_limits.h"

namespace {

using ifog::RestSums;
using ifog::SensorWatch;
using ifog::bench::bias_instability;
using ifog::bench::NoiseKind;
using ifog::bench::SlowNoise;

constexpr double kRate = 200.0, kBlock_s = SensorWatch::kBlock_s;
constexpr double kLook_s = 600.0, kAlarmEvery_s = 30.0 * 86400.0;
constexpr unsigned kWays = 20;  // continuations of one sensor
constexpr int kPerDay = static_cast<int>(86400.0 / kBlock_s), kPerMonth = 30 * kPerDay;

// A sensor in blocks: the contribution of ten seconds of samples to the sums.
class Blocks {
 public:
  Blocks(const NoiseKind& kind, unsigned seed)
      : kind_(kind), random_(seed), slow_(kind, kBlock_s, random_), watch(1, kRate) {}
  void next() {
    constexpr double n = kRate * kBlock_s;
    const double sigma2 = kind_.N * kind_.N * kRate * louder;
    const double mean =
        kind_.N * std::sqrt(louder / kBlock_s) * normal_(random_) + slow_.next(random_) + step;
    RestSums::Axis& sums = sums_.axis[0];
    sums.samples += n;
    sums.rate += n * mean;
    sums.square += sigma2 * (n + std::sqrt(2.0 * n) * normal_(random_));
    sums.pairs += n;
    sums.product += sigma2 * std::sqrt(n) * normal_(random_);
    samples_ += static_cast<std::uint64_t>(n);
    watch.take(sums_, samples_, 0);
  }
  // From here on another continuation.
  void go_on_as(unsigned seed) { random_.seed(seed); }

 private:
  NoiseKind kind_;
  std::mt19937_64 random_;
  SlowNoise slow_;
  std::normal_distribution<double> normal_;
  RestSums sums_;
  std::uint64_t samples_ = 0;

 public:
  SensorWatch watch;
  double step = 0.0, louder = 1.0;
};

void months(int count, unsigned seed, const std::string& word) {
  std::vector<NoiseKind> all = ifog::bench::kinds();
  for (NoiseKind& kind : ifog::bench::wandering_kinds()) all.push_back(std::move(kind));
  for (const NoiseKind& kind : all) {
    if (kind.name.find(word) == std::string::npos) continue;
    int noise = 0, colour = 0, bias = 0;
    for (int month = 0; month < count; ++month) {
      Blocks blocks(kind, seed + static_cast<unsigned>(month));
      std::int32_t before = 0;
      for (int i = 0; i < kPerMonth; ++i) {
        blocks.next();
        const std::int32_t fresh = blocks.watch.noticed() & ~before;
        before = blocks.watch.noticed();
        noise += (fresh & ifog::kNoticedNoise) != 0;
        colour += (fresh & ifog::kNoticedColour) != 0;
        bias += (fresh & ifog::kNoticedBias) != 0;
      }
    }
    std::printf("%-18s %d months: false alarms noise %d, colour %d, bias %d\n", kind.name.c_str(), count,
                noise, colour, bias);
    std::fflush(stdout);
  }
}

struct Change {
  std::string what;
  double step, louder;
  std::int32_t bit;
  std::vector<int> found;  // after so many blocks
  int trials = 0;
};

std::vector<Change> changes(const NoiseKind& kind) {
  std::vector<Change> out{{"variance x 2", 0.0, 2.0, ifog::kNoticedNoise, {}}};
  if (bias_instability(kind) == 0.0) return out;
  for (const double times : {3.3, 5.0, 6.0, 7.0, 10.0}) {
    std::array<char, 40> what{};
    std::snprintf(what.data(), what.size(), "step %.1f B", times);
    out.push_back({what.data(), times * bias_instability(kind), 1.0, ifog::kNoticedBias, {}});
  }
  return out;
}

// Counts if this sensor's change is found within ten minutes.
void look_for(Change& change, Blocks blocks) {
  constexpr int kTenMinutes = static_cast<int>(kLook_s / kBlock_s);
  if ((blocks.watch.noticed() & change.bit) != 0) return;  // a false alarm is not a detection
  ++change.trials;
  blocks.step = change.step;
  blocks.louder = change.louder;
  for (int i = 1; i <= kTenMinutes; ++i) {
    blocks.next();
    if ((blocks.watch.noticed() & change.bit) == 0) continue;
    change.found.push_back(i);
    return;
  }
}

// Prints the fraction found within ten minutes, their median time, and the upper limit of any method.
void steps(int sensors, unsigned seed, const std::string& word) {
  for (const NoiseKind& kind : ifog::bench::kinds()) {
    if (kind.name.find(word) == std::string::npos) continue;
    std::vector<Change> wanted = changes(kind);
    for (int sensor = 0; sensor < sensors; ++sensor) {
      Blocks blocks(kind, seed + static_cast<unsigned>(sensor));
      for (int i = 0; i < 3 * kPerDay; ++i) blocks.next();
      for (unsigned way = 0; way < kWays; ++way) {
        blocks.go_on_as(kWays * (seed + static_cast<unsigned>(sensor)) + way);
        for (Change& change : wanted) look_for(change, blocks);
      }
    }
    for (Change& change : wanted) {
      std::sort(change.found.begin(), change.found.end());
      std::printf("%-18s %-14s found within ten minutes %zu of %d (%.1f %%), median after %.0f s",
                  kind.name.c_str(), change.what.c_str(), change.found.size(), change.trials,
                  100.0 * static_cast<double>(change.found.size()) / change.trials,
                  change.found.empty() ? 0.0 : kBlock_s * change.found[change.found.size() / 2]);
      if (change.step != 0.0) {
        const double d = ifog::bench::deviations(ifog::bench::left_of_step(
            kind, change.step, kBlock_s, static_cast<std::size_t>(kLook_s / kBlock_s)));
        std::printf("; d %.2f, at best %.1f %%", d,
                    100.0 * ifog::bench::best_share(d, kLook_s, kAlarmEvery_s));
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  }
}

// A gyro like that in tools/simulate/scenarios/demo.toml.
void chain(double days, unsigned seed) {
  const NoiseKind gyro{"chain", 2.5e-8, 1.0e-9, 1.0e-11};
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  SlowNoise slow(gyro, 1.0, random);
  ifog::ChainSettings settings;
  settings.facts.axes = 1;
  settings.facts.nominal_rate_hz = kRate;
  settings.axes = {""};
  ifog::SignalChain chain(std::make_unique<ifog::ChainParts>(settings));
  ifog::ChainOutput out;
  ifog::Increment in;
  RestSums sums;
  SensorWatch watch(1, kRate);
  const double sigma = gyro.N * std::sqrt(kRate);
  std::uint64_t samples = 0, at_rest = 0;
  std::int32_t before = 0;
  int alarms = 0;
  const auto start = std::chrono::steady_clock::now();
  for (double second = 0.0; second < days * 86400.0; second += 1.0) {
    const double level = 5e-5 + slow.next(random);
    for (int i = 0; i < static_cast<int>(kRate); ++i) {
      in.sequence = samples++;
      in.dt_s = 1.0 / kRate;
      in.samples = 1;
      in.valid_axes = 1;
      in.rate_radps[0] = level + sigma * normal(random);
      in.delta_theta_rad[0] = in.rate_radps[0] * in.dt_s;
      in.covered_s[0] = in.dt_s;
      chain.process(in, out);
      const bool rests = (out.estimate.flags & ifog::kAtRest) != 0;
      at_rest += rests;
      sums.add(0, rests, out.compensated_radps[0], out.estimate.innovation_radps[0]);
    }
    watch.take(sums, samples, 0);
    if ((watch.noticed() & ~before) != 0) {
      ++alarms;
      std::printf("after %.2f days: %s\n", second / 86400.0, watch.words().c_str());
    }
    before = watch.noticed();
  }
  std::printf("chain at %.0f Hz, %.1f days: %d false alarms, %.2f %% at rest, %.0f s\n", kRate, days, alarms,
              100.0 * static_cast<double>(at_rest) / static_cast<double>(samples),
              std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

}  // namespace

int main(int argc, char** argv) {
  const std::string mode = argc >= 4 ? argv[1] : "", word = argc == 5 ? argv[4] : "";
  const auto seed = static_cast<unsigned>(argc >= 4 ? std::atoi(argv[3]) : 0);
  if (mode == "blocks" && argc <= 5) {
    months(std::atoi(argv[2]), seed, word);
  } else if (mode == "steps" && argc <= 5) {
    steps(std::atoi(argv[2]), seed, word);
  } else if (mode == "limits" && argc <= 5) {
    ifog::bench::print_limits(static_cast<std::size_t>(std::atof(argv[2])), seed, word);
  } else if (mode == "chain" && argc == 4) {
    chain(std::atof(argv[2]), seed);
  } else {
    std::fprintf(stderr,
                 "usage: notice_bench blocks MONTHS SEED [WORD] | steps SENSORS SEED [WORD] | limits BLOCKS "
                 "SEED [WORD] | chain DAYS SEED\n");
    return 2;
  }
  return 0;
}

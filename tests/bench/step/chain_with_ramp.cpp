// SPDX-License-Identifier: Apache-2.0
// Time of a sample through the whole chain with a feedback ramp in the model, relative to the chain without a
// model: after the phase is known, and during acquisition (a record without a ramp).
//
//   chain_with_ramp_bench [rounds]    prints a markdown table
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <random>
#include <vector>

#include "filters/chain/signal_chain.h"

namespace {

constexpr std::size_t kSamples = 40'000;
constexpr double kStep_s = 0.005;
constexpr double kCycles = 77e3;   // per radian
constexpr double kRate = 5.4e-5;   // rad/s
constexpr double kNoise = 4.4e-7;  // rad/s
constexpr int kHarmonics = 96;

double angle_error(double cycles) {
  double sum = 0.0;
  for (int h = 1; h <= kHarmonics; ++h) sum += 5e-9 / h * std::sin(2.0 * M_PI * h * cycles + 0.1 * h * h);
  return sum;
}

std::vector<double> record(bool ramp) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> rate(kSamples);
  double phase = 0.3;
  double before = angle_error(phase);
  for (double& value : rate) {
    const double turned = kRate + kNoise * normal(random);
    phase += kCycles * turned * kStep_s;
    const double now = angle_error(phase);
    value = turned + (ramp ? (now - before) / kStep_s : 0.0);
    before = now;
  }
  return rate;
}

std::shared_ptr<const ifog::Model> model() {
  ifog::Effect effect;
  effect.form = "rebuilt_ramp";
  effect.angle = true;
  effect.period = 1.0;
  for (int i = 0; i <= 4 * kHarmonics; ++i) {
    effect.table_x.push_back(i / (4.0 * kHarmonics));
    effect.table_y.push_back(angle_error(i / (4.0 * kHarmonics)));
  }
  effect.parameters = {{"cycles_per_rad", kCycles, 0.0, "1/rad"},
                       {"noise_density", kNoise * std::sqrt(kStep_s), 0.0, "rad/s/sqrt(Hz)"},
                       {"phase_walk", 1e-4, 0.0, "cycles/sqrt(s)"}};
  auto made = std::make_shared<ifog::Model>();
  made->effects = {effect};
  return made;
}

ifog::SignalChain chain(const std::shared_ptr<const ifog::Model>& model) {
  ifog::ChainSettings settings;
  settings.facts.nominal_rate_hz = 1.0 / kStep_s;
  settings.axes = {""};
  settings.filter.process_noise = 1e-18;
  settings.filter.measurement_noise = kNoise * kNoise;
  settings.model = model;
  return ifog::SignalChain(std::make_unique<ifog::ChainParts>(settings));
}

struct Timed {
  double seconds;
  double corrected;  // fraction of the samples
};

Timed run(const std::vector<double>& rate, const std::shared_ptr<const ifog::Model>& model) {
  ifog::SignalChain with = chain(model);
  ifog::Increment in;
  ifog::ChainOutput out;
  in.dt_s = kStep_s;
  in.covered_s = {kStep_s, 0.0, 0.0};
  in.valid_axes = 1;
  std::size_t corrected = 0;
  const std::clock_t from = std::clock();
  for (const double value : rate) {
    in.rate_radps[0] = value;
    in.delta_theta_rad[0] = value * kStep_s;
    with.process(in, out);
    ++in.sequence;
    corrected += out.compensated_radps[0] != value;
  }
  return {static_cast<double>(std::clock() - from) / CLOCKS_PER_SEC,
          static_cast<double>(corrected) / static_cast<double>(rate.size())};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int count, char** words) {
  const int rounds = count > 1 ? std::atoi(words[1]) : 21;
  const std::vector<double> with_ramp = record(true);
  const std::vector<double> without = record(false);
  const auto ramp = model();
  std::vector<double> plain;
  std::vector<double> known;
  std::vector<double> sought;
  Timed last{};
  Timed never{};
  for (int i = 0; i < rounds; ++i) {
    plain.push_back(run(with_ramp, nullptr).seconds);
    last = run(with_ramp, ramp);
    never = run(without, ramp);
    known.push_back(last.seconds / plain.back());
    sought.push_back(never.seconds / plain.back());
  }
  std::printf("| chain | ns a sample | x without a model | samples corrected |\n|---|---|---|---|\n");
  const double base = median(plain) / kSamples * 1e9;
  std::printf("| without a model | %.0f | 1.00 | 0 %% |\n", base);
  std::printf("| rebuilt ramp, phase known | %.0f | %.2f | %.1f %% |\n", base * median(known), median(known),
              100.0 * last.corrected);
  std::printf("| rebuilt ramp, phase sought | %.0f | %.2f | %.1f %% |\n", base * median(sought),
              median(sought), 100.0 * never.corrected);
  return 0;
}

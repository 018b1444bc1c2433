// SPDX-License-Identifier: Apache-2.0
// Scores with real noise: negative controls with channels of other captures, in which every traced effect is
// a false alarm; and implanted effects, which should be found.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "tests/bench/undeclared/project_diagnosis.h"
#include "tests/unit/capture/read_capture.h"

using namespace ifog::undeclared;
using Series = std::vector<double>;

namespace {

constexpr double kStep_s = 0.5;

struct Source {
  std::string name;
  Series rate;  // means over kStep_s
};

Series resampled(const ifog::Capture& c, const Series& x) {
  const auto count = static_cast<std::size_t>((c.time_s.back() - c.time_s.front()) / kStep_s);
  Series sum(count, 0.0), n(count, 0.0), out;
  for (std::size_t k = 0; k < c.size(); ++k) {
    const auto block = static_cast<std::size_t>((c.time_s[k] - c.time_s.front()) / kStep_s);
    if (block < count && std::isfinite(x[k])) sum[block] += x[k], n[block] += 1.0;
  }
  for (std::size_t b = 0; b < count; ++b)
    out.push_back(n[b] > 0.0 ? sum[b] / n[b] : out.empty() ? 0.0 : out.back());
  return out;
}

// A random part of another capture's column, resampled to `samples`.
Series borrowed(const Series& column, std::size_t samples, Draw& draw) {
  const double length = static_cast<double>(column.size()) * draw.uniform(0.3, 1.0);
  const double start = draw.uniform(0.0, static_cast<double>(column.size()) - length);
  const bool backwards = draw.chance(0.5);
  Series out(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    const double share = static_cast<double>(backwards ? samples - 1 - k : k) / static_cast<double>(samples);
    const double at = start + share * (length - 1.0);
    const auto low = std::min(static_cast<std::size_t>(at), column.size() - 2);
    const double part = at - static_cast<double>(low);
    out[k] = column[low] * (1.0 - part) + column[low + 1] * part;
  }
  return out;
}

// White noise, flicker and random walk by maximum likelihood over a grid of their ratios.
NoiseTruth fitted_noise(const Series& rate) {
  Series x(rate);
  double mean = 0.0;
  for (const double v : rate) mean += v / static_cast<double>(rate.size());
  for (double& v : x) v -= mean;
  NoiseTruth best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const double crossing_s : {30.0, 100.0, 300.0, 1000.0, 1e4, 1e6})
    for (const double flicker_s : {20.0, 60.0, 200.0, 1000.0, 1e6}) {
      NoiseTruth unit{1.0, 1.0 / (0.664 * std::sqrt(flicker_s)), std::sqrt(3.0) / crossing_s};
      const NoiseModel model(unit, x.size(), kStep_s);
      double square = 0.0;
      for (const double w : model.whiten(x)) square += w * w;
      const double variance = square / static_cast<double>(x.size());
      const double cost = static_cast<double>(x.size()) * std::log(variance) + model.log_determinant();
      if (cost >= best_cost) continue;
      best_cost = cost;
      const double scale = std::sqrt(variance);
      best = {unit.N * scale, unit.B * scale, unit.K * scale};
    }
  return best;
}

// True for a channel of another capture, because a capture's own channels may be correlated with its noise.
bool foreign(const std::string& channel, const std::string& source) {
  if (source.starts_with("blueseis")) return channel != "other_gyro";
  return !source.starts_with("rlg") || !channel.starts_with("pressure_");
}

struct Count {
  int trials = 0, found = 0, named = 0, wrong = 0;
  void add(const Count& other) {
    trials += other.trials;
    found += other.found;
    named += other.named;
    wrong += other.wrong;
  }
};

void print_row(const std::string& name, const Count& count) {
  std::printf("| %s | %d | %d | %d | %d |\n", name.c_str(), count.trials, count.found, count.named,
              count.wrong);
}

struct Recordings {
  std::vector<Source> sources;                          // with real noise
  std::vector<std::pair<std::string, Series>> columns;  // to take channels from
};

Recordings recordings(const std::string& folder) {
  const auto read = [&](const char* name) { return ifog::read_capture(folder + "/" + name + ".csv.gz"); };
  const ifog::Capture bridge = read("blueseis_bridge_rbam2"), vehicle = read("rlg_vehicle"),
                      mems = read("adis16405_imu1"), table = read("fog_rate_table"),
                      turned = read("kvh1750_direct_imu_rate");
  Recordings out;
  const Series wander = resampled(bridge, bridge.rate_radps[0]);
  out.sources.push_back({"blueseis_bridge_rbam2", wander});
  out.sources.push_back({"adis16405_imu1", resampled(mems, mems.rate_radps[0])});
  for (std::size_t a = 0; a < 3; ++a) {
    const Series all = resampled(vehicle, vehicle.rate_radps[a]);
    const Series undisturbed(all.begin() + 1100, all.end());
    out.sources.push_back({"rlg_vehicle " + vehicle.axes[a], undisturbed});
  }
  for (std::size_t a = 0; a < 3; ++a)
    out.columns.emplace_back("flow_" + turned.axes[a] + "_lpm", resampled(turned, turned.rate_radps[a]));
  // Without a reference nothing is traced to channels of motion, so accelerations are used as pressures and
  // rates as flows.
  for (const ifog::CaptureColumn& c : vehicle.channels)
    out.columns.emplace_back(
        c.name.starts_with("accel_") ? "pressure_" + c.name.substr(6, 1) + "_Pa" : c.name,
        resampled(vehicle, c.values));
  out.columns.emplace_back("temperature_degC", table.channels[0].values);
  out.columns.emplace_back("flow_lpm", table.reference_rate_radps[0]);
  out.columns.emplace_back("other_gyro", low_passed(wander, 60.0, kStep_s));
  return out;
}

// Part of one source's noise with channels of other captures.
ifog::Capture piece(const Source& source, const Recordings& from, Draw& draw) {
  const std::size_t samples = std::min<std::size_t>(source.rate.size(), 5000);
  const auto start =
      static_cast<std::size_t>(draw.uniform() * static_cast<double>(source.rate.size() - samples));
  ifog::Capture c;
  c.axes = {""};
  for (std::size_t k = 0; k < samples; ++k) c.time_s.push_back(kStep_s * static_cast<double>(k));
  c.rate_radps = {Series(source.rate.begin() + static_cast<std::ptrdiff_t>(start),
                         source.rate.begin() + static_cast<std::ptrdiff_t>(start + samples))};
  c.reference_rate_radps = {{}};
  for (const auto& [name, values] : from.columns)
    if (foreign(name, source.name)) c.channels.push_back({name, borrowed(values, samples, draw)});
  return c;
}

// A lag that is settled at the beginning of the record, at the channel's level; the noise of its first value
// would decay like a warm-up.
Series settled_low_pass(const Series& channel, double tau_s) {
  const auto first = std::min(channel.size(), static_cast<std::size_t>(tau_s / kStep_s));
  double mean = 0.0;
  for (std::size_t k = 0; k < first; ++k) mean += channel[k] / static_cast<double>(first);
  Series led(1, mean);
  led.insert(led.end(), channel.begin(), channel.end());
  const Series out = low_passed(led, tau_s, kStep_s);
  return {out.begin() + 1, out.end()};
}

// Adds an effect of `form` of the channel, 12 to 80 times its standard error in this noise; returns the
// multiple.
double implant_effect(ifog::Capture& c, const Series& channel, const std::string& form, Draw& draw) {
  const std::size_t samples = channel.size();
  Series effect(channel);
  if (form != "linear") {
    const double tau = draw.log_uniform(60.0, 300.0);
    const Series slow = settled_low_pass(channel, tau);
    for (std::size_t k = 0; k < samples; ++k)
      effect[k] = form == "rate" ? (channel[k] - slow[k]) / tau : slow[k];
  }
  const NoiseTruth noise = fitted_noise(c.rate_radps[0]);
  const Visibility oracle(std::make_shared<const NoiseModel>(noise, samples, kStep_s), 1);
  const double sigma = draw.log_uniform(12.0, 80.0);
  const double size = sigma / oracle.of({effect}, {});
  for (std::size_t k = 0; k < samples; ++k) c.rate_radps[0][k] += size * effect[k];
  return sigma;
}

struct Trial {
  std::string source, form, channel;  // implanted form and channel, or empty
  double sigma = 0.0;
  bool hit = false, named = false;
  int others = 0;      // claims of another channel
  std::string claims;  // names of all

  void count_in(Count& count) const {
    ++count.trials;
    count.found += hit ? 1 : 0;
    count.named += named ? 1 : 0;
    count.wrong += others > 0 ? 1 : 0;
  }
};

Trial one_trial(int number, bool implant, const Recordings& from) {
  Draw draw(static_cast<std::uint64_t>(number), 77);
  const Source& source = from.sources[static_cast<std::size_t>(number) % from.sources.size()];
  ifog::Capture c = piece(source, from, draw);
  const auto target = static_cast<std::size_t>(draw.below(static_cast<int>(c.channels.size())));
  const char* forms[] = {"linear", "rate", "lagged"};
  const std::string form = forms[draw.below(3)];
  Trial trial{source.name, implant ? form : "", implant ? c.channels[target].name : "", 0.0, false, false, 0,
              ""};
  if (implant) trial.sigma = implant_effect(c, c.channels[target].values, form, draw);
  const Finding finding = project_diagnosis()({c});
  for (const Claim& claim : finding.effects) {
    trial.claims += " " + name_of(claim.effect);
    if (claim.effect.channel.empty()) continue;  // lines and jumps of the sensor itself
    const bool here = implant && claim.effect.channel == trial.channel && claim.effect.with_channel.empty();
    trial.hit = trial.hit || here;
    trial.named = trial.named || (here && claim.effect.form == form);
    trial.others += here ? 0 : 1;
  }
  return trial;
}

struct Tables {
  std::map<std::string, Count> controls, by_form, by_size, by_source;

  void add(const Trial& trial) {
    if (trial.form.empty()) {
      trial.count_in(controls[trial.source]);
      return;
    }
    trial.count_in(by_form[trial.form]);
    trial.count_in(by_size[trial.sigma < 20.0   ? "12 to 20 sigma"
                           : trial.sigma < 40.0 ? "20 to 40 sigma"
                                                : "40 to 80 sigma"]);
    trial.count_in(by_source[trial.source]);
  }

  void print() const {
    std::printf("| real noise, foreign channels | trials | explained by a channel |\n|---|---|---|\n");
    Count all;
    for (const auto& [name, count] : controls) {
      std::printf("| %s | %d | %d |\n", name.c_str(), count.trials, count.wrong);
      all.add(count);
    }
    std::printf("| all | %d | %d |\n\n", all.trials, all.wrong);
    std::printf(
        "| implanted | trials | channel found | form too | another channel besides "
        "|\n|---|---|---|---|---|\n");
    for (const auto* part : {&by_form, &by_size, &by_source})
      for (const auto& [name, count] : *part) print_row(name, count);
    Count implanted;
    for (const auto& [name, count] : by_form) implanted.add(count);
    print_row("all", implanted);
  }
};

}  // namespace

int main(int argc, char** argv) {
  std::string folder;
  int trials = 100;
  std::vector<int> only;
  CLI::App app{"score the diagnosis on real noise"};
  app.add_option("folder", folder, "of the measured captures")->required()->check(CLI::ExistingDirectory);
  app.add_option("--trials", trials, "of each of: negative controls, implanted effects");
  app.add_option("--only", only, "only the trials of these numbers, as the list of failures gives them");
  CLI11_PARSE(app, argc, argv);

  const Recordings from = recordings(folder);
  Tables tables;
  for (int number = 0; number < 2 * trials; ++number) {
    if (!only.empty() && std::find(only.begin(), only.end(), number) == only.end()) continue;
    const bool implant = number >= trials;
    const Trial trial = one_trial(number, implant, from);
    tables.add(trial);
    if (trial.others > 0 || (implant && !trial.hit))
      std::fprintf(stderr, "trial %d %s %s %.0f sigma: found%s\n", number, trial.source.c_str(),
                   implant ? (trial.form + " " + trial.channel).c_str() : "nothing implanted", trial.sigma,
                   trial.claims.empty() ? " nothing" : trial.claims.c_str());
  }
  tables.print();
  return 0;
}

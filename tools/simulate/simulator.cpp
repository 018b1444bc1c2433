// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/simulator.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "drivers/ifog/quoted.h"
#include "tools/simulate/signals.h"

namespace ifog::simulate {
namespace {

// Streams of the seed: a block for each kind of part, in it one for each part and axis.
constexpr std::uint32_t kChannelStream = 1000, kMotionStream = 2000, kEffectStream = 3000,
                        kNoiseStream = 4000, kRowStream = 5000, kReferenceStream = 6000;
constexpr std::uint32_t kPerAxis = 100'000;
constexpr std::size_t kProgressEvery = 65'536;  // samples

std::uint32_t stream(std::uint32_t block, std::size_t part, std::size_t axis) {
  return block + static_cast<std::uint32_t>(part) + kPerAxis * static_cast<std::uint32_t>(axis);
}

class Simulator {
 public:
  Simulator(const Scenario& scenario, const Progress& progress) : s_(scenario), progress_(progress) {
    if (!(s_.sample_rate_hz > 0.0)) throw std::invalid_argument("sample_rate_hz must be more than 0");
    if (!(s_.duration_s * s_.sample_rate_hz >= 2.0 && s_.duration_s * s_.sample_rate_hz <= 2e9))
      throw std::invalid_argument("duration_s × sample_rate_hz is " +
                                  std::to_string(s_.duration_s * s_.sample_rate_hz) +
                                  " samples, expected 2 to 2·10⁹");
    if (s_.axes.empty() || s_.axes.size() > 3) throw std::invalid_argument("axes must be one to three names");
    grid_ = {s_.sample_rate_hz, static_cast<std::size_t>(std::llround(s_.duration_s * s_.sample_rate_hz))};
  }

  Simulation run() {
    Simulation out;
    Truth& truth = out.truth;
    truth.scenario = s_;
    for (std::size_t a = 0; a < s_.axes.size(); ++a) {
      truth.true_rate_radps.push_back(motion(a));
      made(s_.motions.size());
    }
    for (std::size_t c = 0; c < s_.channels.size(); ++c) {
      const std::size_t axis =
          s_.channels[c].axis.empty() ? 0 : axis_index(s_.channels[c].axis, "channel " + s_.channels[c].name);
      channels_.push_back(channel_signal(s_.channels[c], grid_, truth.true_rate_radps[axis],
                                         Draw(s_.seed, stream(kChannelStream, c, 0))));
      made(1);
    }
    Capture& capture = out.capture;
    capture.axes = s_.axes;
    for (std::size_t a = 0; a < s_.axes.size(); ++a) {
      truth.effect_radps.push_back(effects(a, truth.true_rate_radps));
      made(s_.effects.size());
      capture.rate_radps.push_back(measured(a, truth));
      capture.reference_rate_radps.emplace_back();
      if (s_.reference) capture.reference_rate_radps.back() = reference(a, truth.true_rate_radps[a]);
    }
    for (std::size_t c = 0; c < s_.channels.size(); ++c)
      capture.channels.push_back({s_.channels[c].name, std::move(channels_[c].logged)});
    stamp(capture);
    drop_rows(out);
    return out;
  }

 private:
  [[nodiscard]] std::size_t axis_index(const std::string& axis, const std::string& whose) const {
    for (std::size_t a = 0; a < s_.axes.size(); ++a)
      if (s_.axes[a] == axis) return a;
    throw std::invalid_argument(whose + ": axis " + in_quotes(axis) + " is not among the scenario's axes");
  }

  [[nodiscard]] std::vector<double> motion(std::size_t axis) const {
    std::vector<double> rate(grid_.samples);
    for (std::size_t m = 0; m < s_.motions.size(); ++m) {
      if (!s_.motions[m].axis.empty() &&
          axis_index(s_.motions[m].axis, "motion " + s_.motions[m].kind) != axis)
        continue;
      const auto part = motion_signal(s_.motions[m], grid_, Draw(s_.seed, stream(kMotionStream, m, axis)));
      for (std::size_t i = 0; i < rate.size(); ++i) rate[i] += part[i];
    }
    return rate;
  }

  using Rates = std::vector<std::vector<double>>;

  [[nodiscard]] std::span<const double> channel(const std::string& name, std::size_t axis,
                                                const Rates& true_rates, const std::string& whose) const {
    if (name.empty()) return {};
    if (name == "rate") return true_rates[axis];
    if (name.starts_with("rate_")) return true_rates[axis_index(name.substr(5), whose)];
    for (std::size_t c = 0; c < s_.channels.size(); ++c)
      if (s_.channels[c].name == name) return channels_[c].physical;
    throw std::invalid_argument(
        whose + ": channel " + in_quotes(name) +
        " is not in the scenario, expected one of its channels, 'rate' or 'rate_AXIS'");
  }

  [[nodiscard]] std::vector<std::vector<double>> effects(std::size_t axis, const Rates& true_rates) const {
    std::vector<std::vector<double>> parts;
    for (std::size_t e = 0; e < s_.effects.size(); ++e) {
      const Recipe& effect = s_.effects[e];
      const std::string whose = "effect " + effect.kind;
      const auto whole = channel(effect.channel, axis, true_rates, whose);
      const auto less = channel(effect.minus_channel, axis, true_rates, whose);
      const auto with = channel(effect.with_channel, axis, true_rates, whose);
      std::vector<double> of(whole.begin(), whole.end());
      for (std::size_t i = 0; i < less.size(); ++i) of[i] -= less[i];
      if (!effect.axis.empty() && axis_index(effect.axis, whose) != axis) {
        parts.emplace_back(grid_.samples);
        continue;
      }
      parts.push_back(effect_signal(effect, grid_, of, with, true_rates[axis],
                                    Draw(s_.seed, stream(kEffectStream, e, axis))));
    }
    return parts;
  }

  // Counts signals that are complete.
  void made(std::size_t signals) {
    made_ += signals * grid_.samples;
    tell(0);
  }
  void tell(std::size_t of_the_next) const {
    const std::size_t an_axis = s_.motions.size() + s_.effects.size() + 1;  // with the noise
    if (progress_)
      progress_(made_ + of_the_next, (s_.axes.size() * an_axis + s_.channels.size()) * grid_.samples);
  }

  std::vector<double> measured(std::size_t axis, const Truth& truth) {
    std::vector<double> rate(grid_.samples);
    RateNoise source(s_.noise, s_.sample_rate_hz, grid_.duration(), s_.seed, stream(kNoiseStream, 0, axis));
    for (std::size_t i = 0; i < rate.size(); ++i) {
      if (i % kProgressEvery == 0) tell(i);
      rate[i] = truth.true_rate_radps[axis][i] + s_.bias_radps + source.next();
    }
    made(1);
    for (const auto& part : truth.effect_radps[axis])
      for (std::size_t i = 0; i < rate.size(); ++i) rate[i] += part[i];
    // Last, because the converter rounds the sum.
    quantise_angle(rate, grid_.period(), s_.noise.Q * std::sqrt(12.0));
    for (const Recipe& effect : s_.effects) {
      if (effect.kind != "quantisation" || (!effect.axis.empty() && effect.axis != s_.axes[axis])) continue;
      quantise_angle(rate, grid_.period(), effect["angle_rad"]);
      const double step = effect["rate_radps"];
      if (step > 0.0)
        for (double& r : rate) r = std::round(r / step) * step;
    }
    return rate;
  }

  [[nodiscard]] std::vector<double> reference(std::size_t axis, std::span<const double> true_rate) const {
    std::vector<double> out(true_rate.begin(), true_rate.end());
    Draw draw(s_.seed, stream(kReferenceStream, 0, axis));
    if (s_.reference_noise_radps > 0.0)
      for (double& r : out) r += s_.reference_noise_radps * draw.normal();
    return out;
  }

  void stamp(Capture& capture) const {
    Draw draw(s_.seed, kRowStream);
    capture.time_s.resize(grid_.samples);
    double before = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < grid_.samples; ++i) {
      double t = grid_.time(i);
      if (s_.time_jitter_s > 0.0) t += s_.time_jitter_s * draw.normal();
      before = capture.time_s[i] = std::max(t, before + 1e-6);
    }
  }

  void drop_rows(Simulation& out) const {
    if (s_.missing_rows <= 0.0 && s_.gaps.empty()) return;
    Draw draw(s_.seed, kRowStream + 1);
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < grid_.samples; ++i) {
      const bool lost = draw.chance(s_.missing_rows);
      const double t = grid_.time(i);
      const bool gap =
          std::ranges::any_of(s_.gaps, [t](const auto& g) { return t >= g.first && t < g.second; });
      if (!lost && !gap) kept.push_back(i);
    }
    const auto keep = [&](std::vector<double>& v) {
      if (v.empty()) return;
      for (std::size_t k = 0; k < kept.size(); ++k) v[k] = v[kept[k]];
      v.resize(kept.size());
    };
    keep(out.capture.time_s);
    for (auto& v : out.capture.rate_radps) keep(v);
    for (auto& v : out.capture.reference_rate_radps) keep(v);
    for (auto& c : out.capture.channels) keep(c.values);
    for (auto& v : out.truth.true_rate_radps) keep(v);
    for (auto& axis : out.truth.effect_radps)
      for (auto& v : axis) keep(v);
    if (kept.size() < 2) throw std::invalid_argument("gaps and missing_rows leave fewer than two rows");
  }

  const Scenario& s_;
  Grid grid_;
  std::vector<ChannelSignal> channels_;
  const Progress& progress_;
  std::size_t made_ = 0;  // samples
};

nlohmann::ordered_json recipe_json(const Recipe& recipe) {
  nlohmann::ordered_json out;
  out["kind"] = recipe.kind;
  if (!recipe.name.empty()) out["name"] = recipe.name;
  if (!recipe.axis.empty()) out["axis"] = recipe.axis;
  if (!recipe.channel.empty()) out["channel"] = recipe.channel;
  if (!recipe.minus_channel.empty()) out["minus_channel"] = recipe.minus_channel;
  if (!recipe.with_channel.empty()) out["with_channel"] = recipe.with_channel;
  for (const auto& [key, value] : recipe.number) out[key] = value;
  for (const auto& [key, value] : recipe.list) out[key] = value;
  return out;
}

}  // namespace

Simulation simulate(const Scenario& scenario, const Progress& progress) {
  return Simulator(scenario, progress).run();
}

std::string truth_json(const Truth& truth) {
  const Scenario& s = truth.scenario;
  nlohmann::ordered_json out;
  out["schema"] = "ifog.truth/1";
  out["scenario"] = s.name;
  out["seed"] = s.seed;
  out["sample_rate_hz"] = s.sample_rate_hz;
  out["duration_s"] = s.duration_s;
  out["axes"] = s.axes;
  out["bias_radps"] = s.bias_radps;
  out["noise"] = {{"Q", s.noise.Q}, {"N", s.noise.N}, {"B", s.noise.B}, {"K", s.noise.K}, {"R", s.noise.R}};
  for (const char* part : {"effects", "channels", "motions"}) out[part] = nlohmann::ordered_json::array();
  for (std::size_t e = 0; e < s.effects.size(); ++e) {
    nlohmann::ordered_json effect = recipe_json(s.effects[e]);
    effect["rms_radps"] = nlohmann::ordered_json::object();
    for (std::size_t a = 0; a < s.axes.size(); ++a) {
      double squares = 0.0;
      for (const double x : truth.effect_radps[a][e]) squares += x * x;
      effect["rms_radps"][s.axes[a]] =
          std::sqrt(squares / static_cast<double>(truth.effect_radps[a][e].size()));
    }
    out["effects"].push_back(effect);
  }
  for (const Recipe& channel : s.channels) out["channels"].push_back(recipe_json(channel));
  for (const Recipe& motion : s.motions) out["motions"].push_back(recipe_json(motion));
  return out.dump(1) + "\n";
}

Capture truth_capture(const Truth& truth, const Capture& capture) {
  Capture out;
  out.time_s = capture.time_s;
  out.axes = capture.axes;
  out.rate_radps = truth.true_rate_radps;
  out.reference_rate_radps.resize(out.axes.size());
  for (std::size_t a = 0; a < out.axes.size(); ++a)
    for (std::size_t e = 0; e < truth.effect_radps[a].size(); ++e)
      out.channels.push_back({"effect_" + std::to_string(e + 1) + "_" + truth.scenario.effects[e].kind +
                                  (out.axes[a].empty() ? "" : "_" + out.axes[a]) + "_radps",
                              truth.effect_radps[a][e]});
  return out;
}

}  // namespace ifog::simulate

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/undeclared/sensor.h"
#include "filters/units/field_units.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

namespace ifog::undeclared {
namespace {

using Series = std::vector<double>;
constexpr const char* kTemperature = "temperature_degC";
constexpr const char* kReference = "reference_rate_radps";

// Each kind of draw per capture, and each attempt at a sensor, has its own stream.
enum Stream : std::uint32_t {
  kSensorStream,
  kEnvironmentStream,
  kNoiseStream,
  kPhaseStream,
  kBiasStream,
  kStreams
};
std::uint32_t stream(const Sensor& s, Stream what, int capture = 0) {
  return what + kStreams * (static_cast<std::uint32_t>(capture) + 1000U * s.attempt);
}

TrueEffect simple(const std::string& form, const std::string& channel, double reference, double shape = 0.0) {
  TrueEffect e;
  e.form = form;
  e.channel = channel;
  e.reference = reference;
  e.shape = shape;
  return e;
}

TrueEffect draw_effect(Kind kind, const Sensor& s, Draw& draw) {
  const double record_s = static_cast<double>(s.samples) * s.dt_s;
  switch (kind) {
    case Kind::kTemperatureLinear:
      return simple("linear", kTemperature, 25.0);
    case Kind::kTemperatureQuadratic:
      return simple("quadratic", kTemperature, 25.0);
    case Kind::kTemperatureRate:
      return simple("rate", kTemperature, 0.0, draw.log_uniform(10.0, 120.0));
    case Kind::kTemperatureLagged:
      return simple("lagged", kTemperature, 25.0, draw.log_uniform(60.0, 0.1 * record_s));
    case Kind::kAcceleration:
      return simple("linear", channel_names()[static_cast<std::size_t>(1 + draw.below(3))], 0.0);
    case Kind::kSupply:
      return simple("linear", "supply_V", 12.0);
    case Kind::kMagnetic:
      return simple("linear", channel_names()[static_cast<std::size_t>(5 + draw.below(2))], 0.0);
    case Kind::kLine:
      return simple("line", "", 0.0, draw.log_uniform(0.02, 0.45) / s.dt_s);
    case Kind::kScaleFactor:
      return simple("linear", kReference, 0.0);
    case Kind::kScaleNonlinearity:
      return simple("cubic", kReference, 0.0);
    case Kind::kScaleTemperature: {
      TrueEffect e = simple("linear", kTemperature, 25.0);
      e.with_form = "linear";
      e.with_channel = kReference;
      return e;
    }
    case Kind::kStep:
      return simple("step", "", 0.0, record_s * draw.uniform(0.2, 0.8));
    case Kind::kWarmUp:
      return simple("warm_up", "", 0.0, draw.log_uniform(120.0, 0.15 * record_s));
    case Kind::kUncovered:
      return simple("backlash", kTemperature, 0.0,
                    (s.range.temperature_high - s.range.temperature_low) * draw.uniform(0.12, 0.25));
    default:
      throw std::logic_error("no single effect of this kind");
  }
}

bool needs_reference(Kind kind) {
  return kind == Kind::kScaleFactor || kind == Kind::kScaleNonlinearity || kind == Kind::kScaleTemperature;
}

// Distinct kinds, because two effects of the same kind in one channel would be one effect.
std::vector<Kind> parts_of(Kind kind, Draw& draw) {
  if (kind == Kind::kNothing || kind == Kind::kLookalike) return {};
  if (kind != Kind::kTwo) return {kind};
  std::vector<Kind> singles;
  for (const Kind k : kinds_with_effect())
    if (k != Kind::kTwo && k != Kind::kUncovered) singles.push_back(k);
  const int first = draw.below(static_cast<int>(singles.size()));
  int second = draw.below(static_cast<int>(singles.size()) - 1);
  if (second >= first) ++second;
  return {singles[static_cast<std::size_t>(first)], singles[static_cast<std::size_t>(second)]};
}

// Part of a hysteresis loop that depends on the direction of the temperature: play minus the temperature, so
// that it is not a linear effect.
Series backlash(const Series& temperature, double half_width) {
  Series out(temperature.size());
  double play = temperature.front();
  for (std::size_t k = 0; k < out.size(); ++k) {
    play = std::clamp(play, temperature[k] - half_width, temperature[k] + half_width);
    out[k] = play - temperature[k];
  }
  return out;
}

Series waveform(const TrueEffect& e, const Environment& env, bool diagnosed, double phase) {
  const std::size_t n = env.time_s.size();
  Series out(n);
  if (e.form == "line") {
    for (std::size_t k = 0; k < n; ++k)
      out[k] = std::sin(2.0 * std::numbers::pi * e.shape * env.time_s[k] + phase);
  } else if (e.form == "step") {  // an event of the diagnosed captures only
    for (std::size_t k = 0; k < n; ++k) out[k] = diagnosed && env.time_s[k] >= e.shape ? 1.0 : 0.0;
  } else if (e.form == "warm_up") {
    for (std::size_t k = 0; k < n; ++k) out[k] = std::exp(-env.time_s[k] / e.shape);
  } else {
    const Series& x = e.channel == kReference ? env.reference_radps : env.channel(e.channel).truth;
    if (e.form == "backlash") {
      out = backlash(x, e.shape);
    } else if (e.form == "lagged") {
      out = low_passed(x, e.shape, env.dt_s);
      for (double& value : out) value -= e.reference;
    } else if (e.form == "rate") {
      const Series slow = low_passed(x, e.shape, env.dt_s);
      for (std::size_t k = 0; k < n; ++k) out[k] = (x[k] - slow[k]) / e.shape;  // exact derivative of `slow`
    } else {
      const int power = e.form == "linear" ? 1 : e.form == "quadratic" ? 2 : 3;
      for (std::size_t k = 0; k < n; ++k) out[k] = std::pow(x[k] - e.reference, power);
    }
    if (!e.with_channel.empty())
      for (std::size_t k = 0; k < n; ++k) out[k] *= env.reference_radps[k];
  }
  return out;
}

double correlation(const Series& a, const Series& b) {
  double ma = 0.0, mb = 0.0, ab = 0.0, aa = 0.0, bb = 0.0;
  const double n = static_cast<double>(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) ma += a[k] / n, mb += b[k] / n;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ab += (a[k] - ma) * (b[k] - mb);
    aa += (a[k] - ma) * (a[k] - ma);
    bb += (b[k] - mb) * (b[k] - mb);
  }
  return ab / std::sqrt(std::max(aa * bb, 1e-300));
}

Series draw_noise(const Sensor& s, const Environment& env, int capture) {
  Draw draw(s.seed, stream(s, kNoiseStream, capture));
  if (s.kind != Kind::kLookalike) return s.noise_model->draw(draw);
  Series best;
  double best_correlation = -1.0;
  for (int tries = 0; tries < 20; ++tries) {
    Series candidate = s.noise_model->draw(draw);
    const double c = std::abs(correlation(candidate, env.channel(kTemperature).truth));
    if (c > best_correlation) {
      best_correlation = c;
      best = std::move(candidate);
    }
  }
  return best;
}

Environment environment(const Sensor& s, int capture) {
  Draw draw(s.seed, stream(s, kEnvironmentStream, capture));
  OperatingRange range = s.range;
  range.margin = capture < s.captures ? 0.0 : 0.15;
  return draw_environment(range, s.samples, s.dt_s, s.lively, draw);
}

double line_phase(const Sensor& s, int capture) {
  return 2.0 * std::numbers::pi * Draw(s.seed, stream(s, kPhaseStream, capture)).uniform();
}

void draw_character(Sensor& s, Draw& draw) {
  static constexpr double kRates[] = {1.0, 1.0, 2.0, 5.0, 10.0};  // Hz
  static constexpr double kHours[][2] = {{2.0, 6.0}, {2.0, 6.0}, {1.5, 3.0}, {1.0, 1.5}, {0.8, 1.0}};
  const auto pick = static_cast<std::size_t>(draw.below(5));
  s.dt_s = 1.0 / kRates[pick];
  const double hours = draw.uniform(kHours[pick][0], kHours[pick][1]) / (s.captures > 1 ? 2.0 : 1.0);
  s.samples = static_cast<std::size_t>(hours * 3600.0 / s.dt_s);

  s.noise.N = draw.log_uniform(5e-4, 0.1) * kDegreePerRootHour;
  if (draw.chance(0.7)) s.noise.B = s.noise.N / (0.664 * std::sqrt(draw.log_uniform(100.0, 1e4)));
  // Where random walk and white noise are equal in the Allan deviation: N^2 / tau = K^2 tau / 3.
  const bool lookalike = s.kind == Kind::kLookalike;
  const double crossing_s = lookalike ? draw.log_uniform(30.0, 1000.0) : draw.log_uniform(100.0, 3e4);
  if (lookalike || draw.chance(0.7)) s.noise.K = std::sqrt(3.0) * s.noise.N / crossing_s;

  s.noise_model = std::make_shared<const NoiseModel>(s.noise, s.samples, s.dt_s);

  s.range.temperature_low = draw.uniform(5.0, 20.0);
  s.range.temperature_high = s.range.temperature_low + draw.uniform(18.0, 35.0);
  s.range.temperature_step = draw.chance(0.15) ? 1.0 : draw.chance(0.2) ? 0.125 : 0.0;
  s.range.rate_max = draw.log_uniform(0.2, 4.0);
}

void draw_effects(Sensor& s, Draw& draw) {
  s.range.has_reference = draw.chance(0.2);
  if (s.kind == Kind::kLookalike) s.lively = {kTemperature};
  for (const Kind part : parts_of(s.kind, draw)) {
    s.range.has_reference = s.range.has_reference || needs_reference(part);
    s.effects.push_back(draw_effect(part, s, draw));
    s.lively.push_back(s.effects.back().channel);
  }
}

// False if two effects cannot be distinguished in this environment.
bool size_effects(Sensor& s, double sigma, Draw& draw) {
  if (s.effects.empty()) return true;
  const Visibility oracle = visibility(s);
  std::vector<Visibility::Column> columns(s.effects.size());
  for (int c = 0; c < s.captures; ++c) {
    const Environment env = environment(s, c);
    for (std::size_t i = 0; i < columns.size(); ++i)
      columns[i].push_back(waveform(s.effects[i], env, true, line_phase(s, c)));
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::vector<Visibility::Column> others;
    for (std::size_t j = 0; j < columns.size(); ++j)
      if (j != i) others.push_back(columns[j]);
    const double given_others = oracle.of(columns[i], others);
    if (given_others < 0.2 * oracle.of(columns[i], {})) return false;
    s.effects[i].sigma = sigma;
    s.effects[i].size = draw.sign() * sigma / given_others;
  }
  return true;
}

}  // namespace

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::kNothing:
      return "nothing";
    case Kind::kLookalike:
      return "lookalike walk";
    case Kind::kTemperatureLinear:
      return "temperature linear";
    case Kind::kTemperatureQuadratic:
      return "temperature quadratic";
    case Kind::kTemperatureRate:
      return "temperature rate";
    case Kind::kTemperatureLagged:
      return "temperature lagged";
    case Kind::kAcceleration:
      return "acceleration";
    case Kind::kSupply:
      return "supply";
    case Kind::kMagnetic:
      return "magnetic field";
    case Kind::kLine:
      return "line";
    case Kind::kScaleFactor:
      return "scale factor";
    case Kind::kScaleNonlinearity:
      return "scale nonlinearity";
    case Kind::kScaleTemperature:
      return "scale x temperature";
    case Kind::kStep:
      return "step";
    case Kind::kWarmUp:
      return "warm-up";
    case Kind::kTwo:
      return "two at once";
    case Kind::kUncovered:
      return "no form covers it";
  }
  return "?";
}

const std::vector<Kind>& kinds_with_effect() {
  static const std::vector<Kind> kinds{Kind::kTemperatureLinear,
                                       Kind::kTemperatureQuadratic,
                                       Kind::kTemperatureRate,
                                       Kind::kTemperatureLagged,
                                       Kind::kAcceleration,
                                       Kind::kSupply,
                                       Kind::kMagnetic,
                                       Kind::kLine,
                                       Kind::kScaleFactor,
                                       Kind::kScaleNonlinearity,
                                       Kind::kScaleTemperature,
                                       Kind::kStep,
                                       Kind::kWarmUp,
                                       Kind::kTwo,
                                       Kind::kUncovered};
  return kinds;
}

Visibility visibility(const Sensor& s) { return {s.noise_model, s.captures}; }

Sensor draw_sensor(std::uint64_t seed, Kind kind, double sigma, int captures) {
  for (std::uint32_t attempt = 0;; ++attempt) {
    Sensor s;
    s.seed = seed;
    s.attempt = attempt;
    s.kind = kind;
    s.captures = captures;
    Draw draw(seed, stream(s, kSensorStream));
    draw_character(s, draw);
    draw_effects(s, draw);
    if (size_effects(s, sigma, draw)) return s;
  }
}

Record record(const Sensor& s, int capture) {
  const Environment env = environment(s, capture);
  Record r;
  r.noise = draw_noise(s, env, capture);
  // Switch-on biases are far above the noise.
  r.bias = 20.0 * kDegreePerHour * Draw(s.seed, stream(s, kBiasStream, capture)).normal();
  r.capture.time_s = env.time_s;
  r.capture.axes = {""};
  std::vector<double> rate(r.noise);
  for (double& value : rate) value += r.bias;
  for (const TrueEffect& e : s.effects) {
    Series part = waveform(e, env, capture < s.captures, line_phase(s, capture));
    for (std::size_t k = 0; k < rate.size(); ++k) rate[k] += part[k] *= e.size;
    r.effects.push_back(std::move(part));
  }
  if (s.range.has_reference) {
    for (std::size_t k = 0; k < rate.size(); ++k) rate[k] += env.reference_radps[k];
  }
  r.capture.rate_radps = {std::move(rate)};
  r.capture.reference_rate_radps = {env.reference_radps};
  for (const Channel& c : env.channels) r.capture.channels.push_back({c.name, c.recorded});
  return r;
}

std::string truth_text(const Sensor& s) {
  nlohmann::ordered_json out;
  out["schema"] = "ifog.undeclared/1";
  out["seed"] = s.seed;
  out["kind"] = name_of(s.kind);
  out["samples"] = s.samples;
  out["sample_rate_hz"] = 1.0 / s.dt_s;
  out["noise"] = {{"N", s.noise.N}, {"B", s.noise.B}, {"K", s.noise.K}};
  out["effects"] = nlohmann::ordered_json::array();
  for (const TrueEffect& e : s.effects) {
    nlohmann::ordered_json one{{"form", e.form}, {"channel", e.channel}};
    if (!e.with_channel.empty()) one["with"] = {{"form", e.with_form}, {"channel", e.with_channel}};
    one["reference"] = e.reference;
    one["size"] = e.size;
    one["shape"] = e.shape;
    one["sigma"] = e.sigma;
    out["effects"].push_back(one);
  }
  return out.dump(2) + "\n";
}

}  // namespace ifog::undeclared

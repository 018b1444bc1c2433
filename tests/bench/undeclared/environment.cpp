// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/undeclared/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace ifog::undeclared {
namespace {

using Series = std::vector<double>;
constexpr double kGravity = 9.80665;

// Moves and scales any shape to [low, high].
void fit_into(Series& x, double low, double high) {
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  const double bottom = *least, span = std::max(*most - *least, 1e-30);
  for (double& value : x) value = low + (high - low) * (value - bottom) / span;
}

Series random_walk_like(std::size_t n, double tau_s, double dt_s, Draw& draw) {
  Series x(n);
  const double decay = std::exp(-dt_s / tau_s);
  double state = draw.normal();
  for (double& value : x) {
    value = state;
    state = decay * state + std::sqrt(1.0 - decay * decay) * draw.normal();
  }
  return x;
}

Series dwells(std::size_t n, double dwell_s, double dt_s, Draw& draw) {
  Series x(n);
  double level = draw.normal(), left = dwell_s * draw.uniform(0.5, 1.5);
  for (double& value : x) {
    value = level;
    left -= dt_s;
    if (left <= 0.0) {
      level = draw.normal();
      left = dwell_s * draw.uniform(0.5, 1.5);
    }
  }
  return x;
}

Series temperature(const OperatingRange& range, std::size_t n, double dt_s, Draw& draw) {
  const double record_s = static_cast<double>(n) * dt_s;
  Series x(n);
  switch (draw.below(5)) {
    case 0: {  // ramps between soaks
      const double start = draw.uniform(0.05, 0.3), end = draw.uniform(0.6, 0.95);
      for (std::size_t k = 0; k < n; ++k)
        x[k] =
            std::clamp((static_cast<double>(k) / static_cast<double>(n) - start) / (end - start), 0.0, 1.0);
      if (draw.chance(0.5)) std::reverse(x.begin(), x.end());
      break;
    }
    case 1: {  // cycles
      const double cycles = draw.uniform(1.3, 8.0), phase = draw.uniform(0.0, 2.0 * std::numbers::pi);
      for (std::size_t k = 0; k < n; ++k)
        x[k] = std::sin(2.0 * std::numbers::pi * cycles * static_cast<double>(k) / static_cast<double>(n) +
                        phase);
      break;
    }
    case 2:  // set points of a chamber with its thermal mass
      x = low_passed(dwells(n, record_s / draw.uniform(4.0, 10.0), dt_s, draw), draw.uniform(200.0, 600.0),
                     dt_s);
      break;
    case 3:  // a room
      x = low_passed(random_walk_like(n, record_s / draw.uniform(4.0, 20.0), dt_s, draw),
                     draw.uniform(60.0, 300.0), dt_s);
      break;
    default: {  // triangle
      const double cycles = draw.uniform(1.2, 5.0), phase = draw.uniform();
      for (std::size_t k = 0; k < n; ++k) {
        const double turn = cycles * static_cast<double>(k) / static_cast<double>(n) + phase;
        x[k] = std::abs(2.0 * (turn - std::floor(turn + 0.5)));
      }
    }
  }
  x = low_passed(x, draw.uniform(20.0, 60.0), dt_s);
  const double span = range.temperature_high - range.temperature_low;
  fit_into(x, range.temperature_low + span * draw.uniform(0.0, range.margin),
           range.temperature_high - span * draw.uniform(0.0, range.margin));
  return x;
}

Series record_temperature(const Series& truth, double step, Draw& draw) {
  Series out(truth.size());
  const double resolution = step > 0.0 ? step : 0.01;
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = std::round((truth[k] + 0.01 * draw.normal()) / resolution) * resolution;
  return out;
}

// A slow quantity about `centre`: constant, dwelling at levels, wandering or oscillating.
Series slow_channel(std::size_t n, double dt_s, bool lively, double centre, double amplitude, Draw& draw) {
  const double record_s = static_cast<double>(n) * dt_s;
  Series x(n, 0.0);
  switch (lively ? 1 + draw.below(3) : draw.below(4)) {
    case 1:
      x = dwells(n, record_s / draw.uniform(6.0, 40.0), dt_s, draw);
      break;
    case 2:
      x = random_walk_like(n, record_s / draw.uniform(5.0, 50.0), dt_s, draw);
      break;
    case 3: {
      const double cycles = draw.uniform(2.0, 30.0), phase = draw.uniform(0.0, 2.0 * std::numbers::pi);
      for (std::size_t k = 0; k < n; ++k)
        x[k] = std::sin(2.0 * std::numbers::pi * cycles * static_cast<double>(k) / static_cast<double>(n) +
                        phase);
      break;
    }
    default:
      return Series(n, centre);
  }
  fit_into(x, centre - amplitude, centre + amplitude);
  return x;
}

Series with_noise(const Series& truth, double sigma, Draw& draw) {
  Series out(truth);
  for (double& value : out) value += sigma * draw.normal();
  return out;
}

Series motion(double rate_max, std::size_t n, double dt_s, Draw& draw) {
  Series x;
  switch (draw.below(3)) {
    case 0:
      x = low_passed(dwells(n, draw.uniform(30.0, 150.0), dt_s, draw), 2.0 * dt_s, dt_s);
      break;
    case 1:
      x = random_walk_like(n, draw.uniform(10.0, 100.0), dt_s, draw);
      break;
    default: {
      x.resize(n);
      const double period_s = draw.uniform(20.0, 200.0);
      for (std::size_t k = 0; k < n; ++k) {
        const double t = static_cast<double>(k) * dt_s;
        const double swell = 0.6 + 0.4 * std::sin(2.0 * std::numbers::pi * t / (17.3 * period_s));
        x[k] = swell * std::sin(2.0 * std::numbers::pi * t / period_s);
      }
    }
  }
  fit_into(x, -rate_max, rate_max);
  return x;
}

}  // namespace

std::vector<double> low_passed(const std::vector<double>& x, double tau_s, double dt_s) {
  Series y(x.size());
  const double share = 1.0 - std::exp(-dt_s / tau_s);
  double state = x.front();
  for (std::size_t k = 0; k < x.size(); ++k) y[k] = state += share * (x[k] - state);
  return y;
}

const std::vector<std::string>& channel_names() {
  static const std::vector<std::string> names{"temperature_degC", "accel_x_mps2",    "accel_y_mps2",
                                              "accel_z_mps2",     "supply_V",        "magnetic_x_uT",
                                              "magnetic_y_uT",    "humidity_percent"};
  return names;
}

const Channel& Environment::channel(const std::string& name) const {
  for (const Channel& c : channels)
    if (c.name == name) return c;
  throw std::logic_error("no channel " + name);
}

Environment draw_environment(const OperatingRange& range, std::size_t samples, double dt_s,
                             const std::vector<std::string>& lively, Draw& draw) {
  Environment e;
  e.dt_s = dt_s;
  e.time_s.resize(samples);
  for (std::size_t k = 0; k < samples; ++k) e.time_s[k] = static_cast<double>(k) * dt_s;
  for (const std::string& name : channel_names()) {
    const bool moves = std::find(lively.begin(), lively.end(), name) != lively.end();
    Channel c;
    c.name = name;
    if (name == "temperature_degC") {
      if (moves || draw.chance(0.85))
        c.truth = temperature(range, samples, dt_s, draw);
      else
        c.truth.assign(samples, 0.5 * (range.temperature_low + range.temperature_high));
      c.recorded = record_temperature(c.truth, range.temperature_step, draw);
    } else if (name.starts_with("accel_")) {
      const double centre = name == "accel_z_mps2" ? 0.4 * kGravity : 0.0;
      c.truth = slow_channel(samples, dt_s, moves, centre, 0.6 * kGravity, draw);
      c.recorded = with_noise(c.truth, 0.002, draw);
    } else if (name == "supply_V") {
      c.truth = slow_channel(samples, dt_s, moves, 12.0, 0.6, draw);
      c.recorded = with_noise(c.truth, 0.002, draw);
    } else if (name.starts_with("magnetic_")) {
      c.truth = slow_channel(samples, dt_s, moves, 5.0, 40.0, draw);
      c.recorded = with_noise(c.truth, 0.05, draw);
    } else {
      c.truth = slow_channel(samples, dt_s, moves, 45.0, 12.0, draw);
      c.recorded = with_noise(c.truth, 0.1, draw);
    }
    e.channels.push_back(std::move(c));
  }
  if (range.has_reference) e.reference_radps = motion(range.rate_max, samples, dt_s, draw);
  return e;
}

}  // namespace ifog::undeclared

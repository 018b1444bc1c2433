// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/signals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "tools/simulate/noise.h"

namespace ifog::simulate {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kEarth = 7.292115e-5;  // rad/s, WGS 84
constexpr double kGravity = 9.80665;    // m/s²

// First-order low-pass, settled at its first input; time_constant 0: no filter.
class LowPass {
 public:
  LowPass(double time_constant_s, double period_s)
      : share_(time_constant_s > 0.0 ? -std::expm1(-period_s / time_constant_s) : 1.0) {}
  double operator()(double x) {
    state_ = started_ ? state_ + share_ * (x - state_) : x;
    started_ = true;
    return state_;
  }

 private:
  double share_, state_ = 0.0;
  bool started_ = false;
};

// Level of a repeating list with dwells of equal length at time t.
double level_at(const std::vector<double>& levels, double dwell_s, double t) {
  return levels[static_cast<std::size_t>(t / dwell_s) % levels.size()];
}

// Noise through a resonance: discrete two-pole filter, scaled to the RMS.
std::vector<double> resonance(const Grid& grid, double frequency_hz, double damping, double rms, Draw& draw) {
  const double w = kTurn * std::min(frequency_hz, 0.49 * grid.rate_hz) * grid.period();
  const double r = std::exp(-damping * w);
  const double a1 = 2.0 * r * std::cos(w * std::sqrt(std::max(0.0, 1.0 - damping * damping))), a2 = -r * r;
  // Variance of an AR(2) process with unit input noise.
  const double variance = (1.0 - a2) / ((1.0 + a2) * ((1.0 - a2) * (1.0 - a2) - a1 * a1));
  const double gain = rms / std::sqrt(variance);
  std::vector<double> out(grid.samples);
  double y1 = 0.0, y2 = 0.0;
  const auto settle = static_cast<std::size_t>(std::min(1e6, 10.0 / (1.0 - r)));
  for (std::size_t i = 0; i < settle + grid.samples; ++i) {
    const double y = a1 * y1 + a2 * y2 + draw.normal();
    y2 = y1;
    y1 = y;
    if (i >= settle) out[i - settle] = gain * y;
  }
  return out;
}

std::vector<double> physical_channel(const Recipe& c, const Grid& grid, std::span<const double> true_rate,
                                     Draw& draw) {
  std::vector<double> x(grid.samples);
  const auto fill = [&](auto value) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = value(grid.time(i));
  };
  if (c.kind == "constant") {
    fill([&](double) { return c["level"]; });
  } else if (c.kind == "ramp") {
    fill([&](double t) { return c["from"] + (c["to"] - c["from"]) * t / grid.duration(); });
  } else if (c.kind == "cycle") {
    fill([&](double t) {
      return c["level"] + c["amplitude"] * std::sin(kTurn * t / c["period_s"] + c["phase"]);
    });
  } else if (c.kind == "random_walk") {
    double level = c["level"];
    const double step = c["per_root_s"] * std::sqrt(grid.period());
    fill([&](double) { return level += step * draw.normal(); });
  } else if (c.kind == "gauss_markov") {
    GaussMarkov source(c["sigma"], c["correlation_s"], grid.period(), draw);
    fill([&](double) { return c["level"] + source.next(); });
  } else if (c.kind == "steps") {
    fill([&](double t) { return level_at(c.list.at("levels"), c["dwell_s"], t); });
  } else if (c.kind == "oven") {
    LowPass oven(c["time_constant_s"], grid.period());
    fill([&](double t) { return oven(level_at(c.list.at("levels"), c["dwell_s"], t)); });
  } else if (c.kind == "vibration") {
    x = resonance(grid, c["frequency_hz"], c["damping"], c["rms"], draw);
    const double cycle = c["on_s"] + c["off_s"];
    for (std::size_t i = 0; i < x.size(); ++i) {
      const bool on = c["on_s"] <= 0.0 || std::fmod(grid.time(i), cycle) >= c["off_s"];
      x[i] = c["level"] + (on ? x[i] : 0.0);
    }
  } else if (c.kind == "angle") {  // encoder of a rate table
    double angle = c["start"];
    for (std::size_t i = 0; i < x.size(); ++i) {
      angle += true_rate[i] * grid.period() * c["turn"] / kTurn;
      x[i] = angle -= c["turn"] * std::floor(angle / c["turn"]);
    }
  } else {  // feedback_ramp: phase of the loop, integer counts modulo the register
    double counts = c["start"];
    for (std::size_t i = 0; i < x.size(); ++i) {
      counts += (c["counts_per_rad"] * true_rate[i] + c["counts_per_s"]) * grid.period();
      counts -= c["modulus"] * std::floor(counts / c["modulus"]);
      x[i] = counts;
    }
  }
  return x;
}

double power(double x, double exponent) {
  double out = x;
  for (int k = 1; k < static_cast<int>(std::lround(exponent)); ++k) out *= x;
  return out;
}

double table(const Recipe& e, double x) {
  const std::vector<double>& knots = e.list.at("x");
  const std::vector<double>& values = e.list.at("values");
  const double period = e["period"];
  if (period > 0.0) x -= period * std::floor((x - knots.front()) / period);
  const auto above = std::ranges::upper_bound(knots, x);
  if (above == knots.begin()) return values.front();
  const auto i = static_cast<std::size_t>(above - knots.begin()) - 1;
  if (above == knots.end()) {
    if (period <= 0.0) return values.back();
    // From the last knot over the period to the first
    const double span = knots.front() + period - knots.back();
    return span > 0.0 ? values.back() + (values.front() - values.back()) * (x - knots.back()) / span
                      : values.back();
  }
  return values[i] + (values[i + 1] - values[i]) * (x - knots[i]) / (knots[i + 1] - knots[i]);
}

}  // namespace

ChannelSignal channel_signal(const Recipe& c, const Grid& grid, std::span<const double> true_rate,
                             Draw draw) {
  ChannelSignal signal;
  signal.physical = physical_channel(c, grid, true_rate, draw);
  signal.logged = signal.physical;
  const double resolution = c.kind == "feedback_ramp" ? std::max(1.0, c["resolution"]) : c["resolution"];
  const auto hold = static_cast<std::size_t>(std::max(1.0, std::round(c["every_s"] * grid.rate_hz)));
  // Noise, then the converter's steps, then the bus's update interval.
  for (std::size_t i = 0; i < grid.samples; ++i) {
    double& x = signal.logged[i];
    if (c["noise"] > 0.0) x += c["noise"] * draw.normal();
    if (resolution > 0.0)
      x = c.kind == "feedback_ramp" ? std::floor(x / resolution) * resolution
                                    : std::round(x / resolution) * resolution;
    if (i % hold != 0) x = signal.logged[i - i % hold];
  }
  if (c["missing"] > 0.0)
    for (double& x : signal.logged)
      if (draw.chance(c["missing"])) x = std::numeric_limits<double>::quiet_NaN();
  return signal;
}

std::vector<double> motion_signal(const Recipe& m, const Grid& grid, Draw draw) {
  std::vector<double> rate(grid.samples);
  const auto fill = [&](auto value) {
    for (std::size_t i = 0; i < rate.size(); ++i) rate[i] = value(grid.time(i));
  };
  // Smooth edges by a moving mean over edge_s.
  const auto smooth = [&](double edge_s) {
    const auto width = static_cast<std::size_t>(std::round(edge_s * grid.rate_hz));
    if (width < 2) return;
    std::vector<double> sharp = rate;
    double sum = 0.0;
    for (std::size_t i = 0; i < rate.size(); ++i) {
      sum += sharp[i];
      if (i >= width) sum -= sharp[i - width];
      rate[i] = sum / static_cast<double>(width);
    }
  };
  if (m.kind == "rest") {
    fill([&](double) { return m["rate_radps"]; });
  } else if (m.kind == "turns") {
    const double cycle = m["turn_s"] + m["pause_s"];
    fill([&](double t) {
      const double since = t - m["start_s"];
      if (since < 0.0) return 0.0;
      const auto turn = static_cast<long long>(since / cycle);
      return since - static_cast<double>(turn) * cycle < m["turn_s"]
                 ? (turn % 2 == 0 ? 1.0 : -1.0) * m["rate_radps"]
                 : 0.0;
    });
    smooth(m["edge_s"]);
  } else if (m.kind == "sine") {
    fill([&](double t) { return m["amplitude_radps"] * std::sin(kTurn * t / m["period_s"] + m["phase"]); });
  } else if (m.kind == "rate_table") {
    fill([&](double t) { return level_at(m.list.at("rates_radps"), m["dwell_s"], t); });
    smooth(m["edge_s"]);
  } else if (m.kind == "steps") {
    std::vector<double> levels(static_cast<std::size_t>(grid.duration() / m["dwell_s"]) + 1);
    for (double& level : levels) level = m["sigma_radps"] * draw.normal();
    fill([&](double t) { return level_at(levels, m["dwell_s"], t); });
  } else {  // random
    GaussMarkov source(m["sigma_radps"], m["correlation_s"], grid.period(), draw);
    fill([&](double) { return source.next(); });
  }
  return rate;
}

namespace {

// Inputs and output of an effect: `out` has a zero for each sample of the grid.
struct Making {
  const Recipe& e;
  const Grid& grid;
  std::span<const double> channel, with_channel, true_rate;
  Draw draw;
  std::vector<double>& out;

  template <typename Of>
  void each(Of&& of) const {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = of(i);
  }
};

// Adds an effect of the channel's present value. False: another kind of effect.
bool make_of_value(const Making& m) {
  const Recipe& e = m.e;
  const std::span<const double> channel = m.channel;
  static const std::vector<std::pair<const char*, double>> kPowers{
      {"linear", 1}, {"quadratic", 2}, {"cubic", 3}, {"quintic", 5}, {"septic", 7}};
  for (const auto& [name, exponent] : kPowers)
    if (e.kind == name) {
      m.each([&, power_of = exponent](std::size_t i) {
        return e["coefficient"] * power(channel[i] - e["reference"], power_of);
      });
      return true;
    }
  if (e.kind == "absolute") {
    m.each([&](std::size_t i) { return e["coefficient"] * std::abs(channel[i] - e["reference"]); });
  } else if (e.kind == "dead_zone") {
    m.each([&](std::size_t i) {
      return std::abs(channel[i]) < e["half_width"] ? e["coefficient"] * channel[i] : 0.0;
    });
  } else if (e.kind == "cosine" || e.kind == "sine") {
    m.each([&](std::size_t i) {
      const double phase = kTurn * channel[i] / e["period"];
      return e["coefficient"] * (e.kind == "sine" ? std::sin(phase) : std::cos(phase));
    });
  } else if (e.kind == "earth_rate") {
    // Earth's rate along an axis in the direction of the heading, tilted as its accelerometer measures.
    const double latitude = e["latitude_deg"] * kTurn / 360.0;
    const double north = std::cos(latitude) * std::cos(e["heading_deg"] * kTurn / 360.0);
    m.each([&](std::size_t i) {
      const double up = std::clamp(channel[i] / kGravity, -1.0, 1.0);
      return kEarth * (north * std::sqrt(1.0 - up * up) + std::sin(latitude) * up);
    });
  } else if (e.kind == "product") {
    m.each([&](std::size_t i) {
      return e["coefficient"] * power(channel[i] - e["reference"], e["power"]) *
             power(m.with_channel[i] - e["with_reference"], e["with_power"]);
    });
  } else {
    return false;
  }
  return true;
}

// Adds an effect of the channel's history.
bool make_of_history(const Making& m) {
  const Recipe& e = m.e;
  const std::span<const double> channel = m.channel;
  const double period = m.grid.period();
  if (e.kind == "rate" || e.kind == "second_rate") {
    LowPass first(e["time_constant_s"], period), second(e["time_constant_s"], period);
    double x1 = 0.0, d1 = 0.0;
    m.each([&](std::size_t i) {
      const bool twice = e.kind == "second_rate";
      const double x = twice ? second(first(channel[i])) : first(channel[i]);
      const double d = i > 0 ? (x - x1) / period : 0.0;
      const double value = e["coefficient"] * (twice ? (i > 1 ? (d - d1) / period : 0.0) : d);
      x1 = x;
      d1 = d;
      return value;
    });
  } else if (e.kind == "lagged") {
    LowPass first(e["time_constant_s"], period), second(e["second_s"], period);
    m.each([&](std::size_t i) { return e["coefficient"] * (second(first(channel[i])) - e["reference"]); });
  } else if (e.kind == "lookup") {
    double before = table(e, channel.empty() ? 0.0 : channel[0]);
    m.each([&](std::size_t i) {
      const double value = table(e, channel[i]);
      return e["angle"] > 0.5 ? (value - std::exchange(before, value)) / period : value;
    });
  } else if (e.kind == "band_power") {
    LowPass slow(e["time_constant_s"], period), mean(e["mean_s"], period);
    m.each([&](std::size_t i) {
      const double fast = channel[i] - slow(channel[i]);
      return e["coefficient"] * mean(fast * fast);
    });
  } else if (e.kind == "backlash") {
    // Play of the given width: the output changes only at one of its sides.
    const double half = 0.5 * e["width"];
    double play = channel.empty() ? 0.0 : channel[0];
    m.each([&](std::size_t i) {
      play = std::clamp(play, channel[i] - half, channel[i] + half);
      return e["coefficient"] * play;
    });
  } else {
    return false;
  }
  return true;
}

// Adds an effect of time or chance, without a channel.
void make_of_time(Making& m) {
  const Recipe& e = m.e;
  const Grid& grid = m.grid;
  const double period = grid.period();
  if (e.kind == "line") {
    double turns = 0.0;
    m.each([&](std::size_t i) {
      const double value = e["amplitude_radps"] * std::sin(kTurn * turns + e["phase"]);
      turns += (e["frequency_hz"] + e["hz_per_radps"] * m.true_rate[i]) * period;
      turns -= std::floor(turns);
      return value;
    });
  } else if (e.kind == "step") {
    m.each([&](std::size_t i) { return grid.time(i) >= e["at_s"] ? e["size_radps"] : 0.0; });
  } else if (e.kind == "rate_ramp") {
    m.each([&](std::size_t i) { return e["slope_radps2"] * grid.time(i); });
  } else if (e.kind == "warm_up") {
    m.each([&](std::size_t i) { return e["size_radps"] * std::exp(-grid.time(i) / e["time_constant_s"]); });
  } else if (e.kind == "gauss_markov") {
    GaussMarkov source(e["sigma_radps"], e["correlation_s"], period, m.draw);
    m.each([&](std::size_t) { return source.next(); });
  } else if (e.kind == "outliers") {
    m.each([&](std::size_t) {
      const bool hit = m.draw.chance(e["fraction"]);
      const double size = e["size_radps"] * m.draw.normal();
      return hit ? size : 0.0;
    });
  } else if (e.kind == "noise_change") {
    const double sigma = e["N"] * std::sqrt(grid.rate_hz);
    m.each([&](std::size_t i) {
      const double value = sigma * m.draw.normal();
      return grid.time(i) >= e["from_s"] && grid.time(i) < e["to_s"] ? value : 0.0;
    });
  }
}

}  // namespace

std::vector<double> effect_signal(const Recipe& e, const Grid& grid, std::span<const double> channel,
                                  std::span<const double> with_channel, std::span<const double> true_rate,
                                  Draw draw) {
  std::vector<double> out(grid.samples);
  Making making{e, grid, channel, with_channel, true_rate, draw, out};
  if (!make_of_value(making) && !make_of_history(making)) make_of_time(making);
  return out;
}

}  // namespace ifog::simulate

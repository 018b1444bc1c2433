// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/undeclared/structure.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "tests/bench/undeclared/draw.h"

namespace ifog::undeclared {
namespace {

constexpr double kTower_hz = 0.54;
constexpr double kTurn = 2.0 * std::numbers::pi;

// In one expression the compiler chooses the order of two draws, which differs on aarch64.
std::complex<double> deviate(Draw& draw) {
  const double imaginary = draw.normal(), real = draw.normal();
  return {real, imaginary};
}

// The angle is that of a damped oscillator driven by white noise; a sample is its increment.
void sway(const Capture& c, double rms, double quality, Draw& draw, std::vector<double>& rate) {
  const double angle = rms / (kTurn * kTower_hz);
  std::complex<double> state = angle * deviate(draw);
  double dt = c.time_s[1] - c.time_s[0];
  for (std::size_t k = 0; k < rate.size(); ++k) {
    if (k > 0) dt = c.time_s[k] - c.time_s[k - 1];
    const double left = std::exp(-dt * std::numbers::pi * kTower_hz / quality);
    const std::complex<double> next = state * std::polar(left, kTurn * kTower_hz * dt) +
                                      angle * std::sqrt(1.0 - left * left) * deviate(draw);
    rate[k] += (next.real() - state.real()) / dt;
    state = next;
  }
}

// The frequency drifts without repetition, because repetition would give a family of constant lines.
void wander(const Capture& c, double amplitude, Draw& draw, std::vector<double>& rate) {
  const double span_s = c.time_s.back() - c.time_s.front();
  const double sample_s = span_s / static_cast<double>(c.size() - 1);
  const double middle_hz = draw.uniform(0.1, 0.45) / sample_s;
  const double memory = std::exp(-sample_s / (span_s / draw.uniform(3.0, 20.0)));
  double away_hz = 0.05 * middle_hz * draw.normal();
  double phase = draw.uniform();
  for (double& value : rate) {
    value += amplitude * std::sin(kTurn * phase);
    phase += (middle_hz + away_hz) * sample_s;
    away_hz = memory * away_hz + 0.05 * middle_hz * std::sqrt(1.0 - memory * memory) * draw.normal();
  }
}

}  // namespace

const std::vector<std::string>& structures() {
  static const std::vector<std::string> names = {"tower", "machine"};
  return names;
}

std::vector<Capture> standing_on(const std::string& structure, const Sensor& sensor,
                                 std::vector<Capture> captures) {
  if (std::find(structures().begin(), structures().end(), structure) == structures().end())
    throw std::invalid_argument("'" + structure + "' is no structure to stand on");
  Draw draw(sensor.seed, 5454);
  for (Capture& capture : captures) {
    std::vector<double> motion(capture.size(), 0.0);
    sway(capture, draw.log_uniform(10.0, 50.0) * sensor.noise.N, draw.uniform(20.0, 40.0), draw, motion);
    if (structure == "machine") wander(capture, draw.log_uniform(3.0, 30.0) * sensor.noise.N, draw, motion);
    // A capture is identified by its first value.
    for (std::size_t k = 0; k < motion.size(); ++k) capture.rate_radps[0][k] += motion[k] - motion[0];
  }
  return captures;
}

Diagnose moved_by(const std::string& structure, const Sensor& sensor, Diagnose inner) {
  return [structure, sensor, inner = std::move(inner)](const std::vector<Capture>& captures) {
    return inner(standing_on(structure, sensor, captures));
  };
}

}  // namespace ifog::undeclared

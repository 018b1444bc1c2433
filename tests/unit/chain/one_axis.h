// SPDX-License-Identifier: Apache-2.0
// A sensor of one axis at 1 kHz as the chain's tests want it: its settings, and what it sends at 0.01 rad/s.
#pragma once

#include "filters/chain/incrementer.h"
#include "filters/chain/signal_chain.h"
#include "tests/unit/test.h"

namespace ifog {

inline constexpr double kPeriod_s = 1e-3;
inline constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;  // where the tests of clocks begin
inline constexpr double kTurning = 0.1;                               // rad/s, how fast their device turns

inline ChainSettings settings(double q = 1e-10, double r = 1e-8) {
  ChainSettings out;
  out.facts.nominal_rate_hz = 1.0 / kPeriod_s;
  out.facts.sequence_modulus = 128;
  out.axes = {""};
  out.filter.process_noise = q;
  out.filter.measurement_noise = r;
  return out;
}

// A model with one effect.
inline std::shared_ptr<const Model> linear_in(const std::string& channel, double reference,
                                              ModelParameter coefficient) {
  Effect effect;
  effect.form = "linear";
  effect.channel = channel;
  effect.reference = reference;
  effect.parameters = {std::move(coefficient)};
  Model model;
  model.effects = {std::move(effect)};
  return std::make_shared<const Model>(std::move(model));
}

inline std::vector<Increment> increments(int n, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0.01, 1e-4);
  std::vector<Increment> out;
  Incrementer incrementer(settings().facts);
  Increment increment;
  for (int i = 0; i < n; ++i) {
    Reading reading;
    reading.sequence = static_cast<std::uint32_t>(i % 128);
    reading.has_sequence = true;
    reading.valid_axes = 1;
    reading.value[0] = normal(engine);
    incrementer.next(reading, increment);
    out.push_back(increment);
  }
  return out;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// A diagnosis to make a page of: a gyro whose bias follows its temperature and, through a table of angle, its
// feedback ramp; filled in by hand, so that the page is tested without the search.
#pragma once

#include "filters/diagnosis/diagnose.h"
#include "filters/random/philox.h"
#include "tests/unit/test.h"

namespace ifog::example {

inline double noise(std::uint32_t k) {
  const PhiloxBlock b = philox({k, 0, 0, 0}, {1, 2});
  double sum = -2.0;
  for (const std::uint32_t v : b) sum += v / 4294967296.0;
  return sum * std::sqrt(3.0);
}

struct Example {
  std::vector<double> time_s, rate, temperature, ramp;
  Diagnosis diagnosis;

  [[nodiscard]] std::vector<Record> records() const {
    Record r;
    r.name = "bench.csv";
    r.time_s = time_s;
    r.rate_radps = rate;
    r.channels = {{"temperature_degC", temperature}, {"ramp_counts", ramp}};
    return {r};
  }
};

inline constexpr double kPerDegree = 2e-8;  // rad/s per degC
inline double ramp_angle(double counts) { return 2e-7 * std::sin(2.0 * std::numbers::pi * counts / 32768.0); }

inline constexpr std::size_t kSamples = 40000;
inline constexpr double kPeriod_s = 0.05;

// What the rate is made of besides its mean.
struct Parts {
  std::vector<double> noise, temperature, ramp;
};

inline Parts make_record(Example& e) {
  Parts parts;
  double counts = 100.0, previous = ramp_angle(counts);
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double t = static_cast<double>(k) * kPeriod_s;
    e.time_s.push_back(t);
    e.temperature.push_back(25.0 + 12.0 * std::sin(t / 300.0));
    counts = std::fmod(counts + 701.3, 32768.0);
    e.ramp.push_back(counts);
    parts.noise.push_back(6e-7 * noise(static_cast<std::uint32_t>(k)));
    parts.temperature.push_back(kPerDegree * (e.temperature[k] - 25.0));
    parts.ramp.push_back((ramp_angle(counts) - previous) / kPeriod_s);
    previous = ramp_angle(counts);
    e.rate.push_back(parts.noise[k] + parts.temperature[k] + parts.ramp[k] + 5e-5);
  }
  return parts;
}

inline void make_findings(Diagnosis& d) {
  d.samples = kSamples;
  d.sample_rate_hz = 1.0 / kPeriod_s;
  d.noise.N = 6e-7 * std::sqrt(kPeriod_s);
  FoundEffect linear;
  linear.effect.form = "linear";
  linear.effect.channel = "temperature_degC";
  linear.effect.reference = 25.0;
  linear.effect.meaning = "bias follows the temperature";
  linear.effect.parameters = {{"coefficient", kPerDegree, 3e-10, "rad/s/degC"}};
  linear.p_value = 1e-12;
  linear.variance_explained = 0.8;
  FoundEffect lookup;
  lookup.effect.form = "lookup";
  lookup.effect.channel = "ramp_counts";
  lookup.effect.angle = true;
  lookup.effect.period = 32768.0;
  for (int i = 0; i <= 32; ++i) {
    lookup.effect.table_x.push_back(1024.0 * i);
    lookup.effect.table_y.push_back(ramp_angle(1024.0 * i));
  }
  lookup.effect.meaning = "nonlinearity of the closed loop's feedback ramp <2 pi reset>";
  lookup.p_value = 0.0004;
  lookup.variance_explained = 0.1;
  d.effects = {linear, lookup};
  const double r = 1e-6;
  d.before = {{"residual_rms_radps", 1.4 * r}, {"rms_1s_radps", 0.4 * r},   {"rms_10s_radps", 0.2 * r},
              {"adev_1s_radps", 0.13 * r},     {"heading_drift_rad", 2e-4}, {"whiteness", 0.7}};
  d.after = {{"residual_rms_radps", 0.6 * r}, {"rms_1s_radps", 0.13 * r},    {"rms_10s_radps", 0.04 * r},
             {"adev_1s_radps", 0.13 * r},     {"heading_drift_rad", 1.1e-5}, {"whiteness", 0.01}};
  Effect lagged = linear.effect;
  lagged.form = "lagged";
  d.indistinguishable = {{{linear.effect, lagged}, 0.993, "a capture with faster changes of temperature"}};
  d.unexplained.kind = "bursts";
  d.unexplained.fraction = 0.04;
  d.unexplained.hint = "isolated samples far outside the noise";
  d.unexplained.times_s = {444.0};
  d.heading.aligned_s = 120.0;
  for (int i = 1; i <= 60; ++i) {
    d.heading.after_s.push_back(60.0 * i);
    d.heading.sigma_rad.push_back(3e-8 * 60.0 * i + 2e-7 * std::sqrt(60.0 * i));
  }
}

inline void make_series(DiagnosisSeries& s, const Example& e, const Parts& parts) {
  const std::size_t block = 20;
  s.names = {"linear temperature_degC", "lookup ramp_counts"};
  s.contribution_radps.resize(2);
  const auto mean = [&](const std::vector<double>& of, std::size_t from) {
    return std::accumulate(&of[from], &of[from] + block, 0.0) / static_cast<double>(block);
  };
  for (std::size_t k = 0; k + block <= kSamples; k += block) {
    s.time_s.push_back(e.time_s[k]);
    s.after_radps.push_back(mean(parts.noise, k));
    s.contribution_radps[0].push_back(mean(parts.temperature, k));
    s.contribution_radps[1].push_back(mean(parts.ramp, k));
    s.before_radps.push_back(mean(parts.noise, k) + mean(parts.temperature, k) + mean(parts.ramp, k));
  }
  s.frequency_hz = {1e-3, 1e-2, 1.0, 10.0};
  s.after_radps_rthz = {2e-7, 2e-7, 2e-7, 2e-7};
  s.before_radps_rthz = {3e-6, 5e-7, 4e-6, 2e-7};
  s.tau_s = {0.05, 1.0, 20.0, 400.0};
  s.after_adev_radps = {6e-7, 1.34e-7, 3e-8, 7e-9};
  s.after_adev_low_radps = {5.9e-7, 1.3e-7, 2.8e-8, 5e-9};
  s.after_adev_high_radps = {6.1e-7, 1.38e-7, 3.2e-8, 9e-9};
  s.before_adev_radps = {6e-7, 1.35e-7, 4e-8, 3e-7};
}

inline Example make() {
  Example e;
  const Parts parts = make_record(e);
  make_findings(e.diagnosis);
  make_series(e.diagnosis.series, e, parts);
  return e;
}

}  // namespace ifog::example

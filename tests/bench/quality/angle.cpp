// SPDX-License-Identifier: Apache-2.0
// Compares ways of conserving the angle: the loss over a turn, the response to coning and to a sea, and the
// cost at rest.
//
//   angle_bench     prints a markdown table, a minute or two
//
// Rest: RMSE relative to the Kalman filter with true Q and R, Q/R = 1e-3. Turn: 50 deg/s as a step, then
// decreasing over ten seconds; the permanent heading error. Coning of 10 x 3 degrees at 0.1 Hz, and roll and
// pitch of a sea: drift that the filter adds to an attitude integrated from its output over 300 s. Gyro of
// 0.01 deg/sqrt(h).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "filters/estimator/estimator.h"
#include "filters/kalman/core.h"
#include "filters/rules/rule.h"
#include "filters/units/field_units.h"
#include "tests/bench/quality/scenarios.h"

namespace {

using ifog::kDegree;
constexpr double kRatio = 1e-3;

using Axes = std::array<double, 3>;
using Filter = std::function<Axes(const Axes& rate)>;

ifog::FilterSettings settings_of(double noise, double period) {
  ifog::FilterSettings settings;
  settings.measurement_noise = noise * noise;
  settings.process_noise = kRatio * noise * noise / period;
  return settings;
}

Filter estimator(const ifog::FilterSettings& settings, double period) {
  auto filter = std::make_shared<ifog::Estimator>(settings, 3, period);
  return [filter, period, sequence = std::uint64_t{0}](const Axes& rate) mutable {
    ifog::EstimatorInput in;
    in.sequence = sequence++;
    in.dt_s = period;
    in.valid_axes = 7;
    in.rate_radps = rate;
    ifog::EstimatorOutput out;
    filter->step(in, out);
    return out.denoised_radps;
  };
}

Filter one_per_axis(const ifog::FilterSettings& settings, double period) {
  std::vector<std::shared_ptr<ifog::Estimator>> filters;
  for (int a = 0; a < 3; ++a) filters.push_back(std::make_shared<ifog::Estimator>(settings, 1, period));
  return [filters, period, sequence = std::uint64_t{0}](const Axes& rate) mutable {
    ifog::EstimatorInput in;
    in.sequence = sequence++;
    in.dt_s = period;
    in.valid_axes = 1;
    ifog::EstimatorOutput out;
    Axes all{};
    for (std::size_t a = 0; a < 3; ++a) {
      in.rate_radps[0] = rate[a];
      filters[a]->step(in, out);
      all[a] = out.denoised_radps[0];
    }
    return all;
  };
}

// Angle and rate are states, the summed increments are the measurement, with the rule's gain on its
// innovation. Missing angle stays in the innovation until it is recovered.
Filter angle_state(const ifog::FilterSettings& settings, double period) {
  struct State {
    ifog::KalmanCore<2> core;
    std::unique_ptr<ifog::Rule> rule;
    Axes angle{};
    std::uint64_t sequence = 0;
  };
  auto state = std::make_shared<State>();
  ifog::FilterSettings of_angle = settings;
  of_angle.measurement_noise *= period * period;
  state->rule = ifog::make_rule(of_angle);
  state->core.h << 1.0, 0.0;
  state->core.p.diagonal() << of_angle.measurement_noise, settings.measurement_noise;
  Eigen::Matrix2d transition, driving;
  transition << 1.0, period, 0.0, 1.0;
  driving << period * period * period / 3, period * period / 2, period * period / 2, period;
  driving *= settings.process_noise;
  // White noise of the rate is a random walk of the angle.
  driving(0, 0) += settings.measurement_noise * period * period;
  return [state, transition, driving, period](const Axes& rate) {
    auto& core = state->core;
    core.predict(transition, driving);
    Axes innovation{};
    for (std::size_t a = 0; a < 3; ++a) {
      state->angle[a] += rate[a] * period;
      innovation[a] = state->angle[a] - core.h.dot(core.x.col(static_cast<Eigen::Index>(a)));
    }
    core.correct(state->rule->innovation_covariance(
        {core.h.dot(core.p * core.h), 1.0, innovation, state->sequence++, 0}));
    Axes out{};
    for (int a = 0; a < 3; ++a) {
      core.update(a, innovation[static_cast<std::size_t>(a)]);
      out[static_cast<std::size_t>(a)] = core.x(1, a);
    }
    return out;
  };
}

struct Candidate {
  const char* name;
  std::function<Filter(double noise, double period)> make;
};

std::vector<Candidate> candidates() {
  const auto with = [](bool follow, bool conserve) {
    return [follow, conserve](double noise, double period) {
      ifog::FilterSettings s = settings_of(noise, period);
      s.follow_manoeuvres = follow;
      s.conserve_angle = conserve;
      return estimator(s, period);
    };
  };
  return {{"nothing: plain irwe-akfg", with(false, false)},
          {"angle state, irwe-akfg's gain",
           [](double noise, double period) { return angle_state(settings_of(noise, period), period); }},
          {"ledger (residual integral fed back) without following", with(false, true)},
          {"following, no ledger", with(true, false)},
          {"following and ledger, a gain for each axis",
           [](double noise, double period) { return one_per_axis(settings_of(noise, period), period); }},
          {"following and ledger, one gain (the daemon's)", with(true, true)}};
}

double at_rest(const Candidate& candidate) {
  double ours = 0.0, best = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    std::array<ifog::bench::Record, 3> records;
    for (std::size_t a = 0; a < 3; ++a)
      records[a] = ifog::bench::make_record(ifog::bench::scenarios()[0], 3 * seed + a, 20'000, kRatio);
    const Filter filter = candidate.make(1.0, 0.01);
    const std::vector<double> truth = ifog::bench::told_the_truth(records[0].measured, kRatio);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Axes out = filter({records[0].measured[i], records[1].measured[i], records[2].measured[i]});
      if (i < 1000) continue;
      ours += std::pow(out[0] - records[0].truth[i], 2);
      best += std::pow(truth[i] - records[0].truth[i], 2);
    }
  }
  return std::sqrt(ours / best);
}

double gyro_noise(double period) { return 0.01 * kDegree / 60 / std::sqrt(period); }

// Permanent heading error in degrees: mean over the last ten of sixty seconds.
double over_a_turn(const Candidate& candidate) {
  const double period = 1e-3, noise = gyro_noise(period);
  const Filter filter = candidate.make(noise, period);
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  double lost = 0.0, mean = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    const double t = i * period - 5.0;
    double turn = 0.0;
    if (t >= 0 && t < 5) turn = 50 * kDegree;
    if (t >= 5 && t < 15) turn = 50 * kDegree * (0.5 + 0.5 * std::cos((t - 5) / 10 * std::numbers::pi));
    const Axes rate{turn + noise * normal(random), noise * normal(random), noise * normal(random)};
    lost += (filter(rate)[0] - rate[0]) * period;
    if (i >= 50'000) mean += lost / 10'000;
  }
  return std::abs(mean) / kDegree;
}

using Quaternion = std::array<double, 4>;

Quaternion times(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}
Quaternion inverse(const Quaternion& a) { return {a[0], -a[1], -a[2], -a[3]}; }
Quaternion turned(double x, double y, double z) {
  const double angle = std::sqrt(x * x + y * y + z * z);
  const double s = angle > 0 ? std::sin(angle / 2) / angle : 0.5;
  return {std::cos(angle / 2), x * s, y * s, z * s};
}

Quaternion cone(double envelope, double t) {
  const double phase = 2 * std::numbers::pi * 0.1 * t;
  return turned(10 * kDegree * envelope * std::cos(phase), 3 * kDegree * envelope * std::sin(phase), 0);
}
Quaternion sea(double envelope, double t) {
  const double w = 2 * std::numbers::pi * 0.1;
  return times(turned(0, 4 * kDegree * envelope * std::sin(1.3 * w * t + 1), 0),
               turned(12 * kDegree * envelope * (std::sin(w * t) + 0.3 * std::sin(1.7 * w * t)), 0, 0));
}

// Largest component of the added drift, deg/h.
double drift(const Candidate& candidate, Quaternion (*attitude)(double, double), double period) {
  constexpr double still = 10.0, moving = 300.0;
  const double noise = gyro_noise(period);
  const auto at = [&](double t) {
    const double inside = std::clamp(std::min(t - still, still + moving - t) / 10.0, 0.0, 1.0);
    return attitude(inside * inside * (3 - 2 * inside), t - still);
  };
  const Filter filter = candidate.make(noise, period);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Quaternion measured{1, 0, 0, 0}, denoised{1, 0, 0, 0}, before = at(0);
  const int length = static_cast<int>((moving + 2 * still) / period);
  for (int i = 1; i < length; ++i) {
    const Quaternion now = at(i * period);
    const Quaternion step = times(inverse(before), now);
    before = now;
    const double sine = std::sqrt(step[1] * step[1] + step[2] * step[2] + step[3] * step[3]);
    const double scale = sine > 0 ? 2 * std::atan2(sine, step[0]) / sine / period : 0.0;
    Axes rate{};
    for (std::size_t a = 0; a < 3; ++a) rate[a] = scale * step[a + 1] + noise * normal(random);
    const Axes out = filter(rate);
    measured = times(measured, turned(rate[0] * period, rate[1] * period, rate[2] * period));
    denoised = times(denoised, turned(out[0] * period, out[1] * period, out[2] * period));
  }
  const Quaternion apart = times(inverse(measured), denoised);
  return 2 / kDegree * 3600 / moving * std::max({std::abs(apart[1]), std::abs(apart[2]), std::abs(apart[3])});
}

}  // namespace

int main() {
  std::printf(
      "| way | rest, RMSE | turn, deg lost | coning 1 kHz, deg/h | coning 100 Hz, deg/h | sea 1 kHz, deg/h "
      "|\n"
      "|---|---|---|---|---|---|\n");
  for (const Candidate& candidate : candidates()) {
    std::printf("| %s | %.3f | %.2g | %.2g | %.2g | %.2g |\n", candidate.name, at_rest(candidate),
                over_a_turn(candidate), drift(candidate, cone, 1e-3), drift(candidate, cone, 1e-2),
                drift(candidate, sea, 1e-3));
    std::fflush(stdout);
  }
  return 0;
}

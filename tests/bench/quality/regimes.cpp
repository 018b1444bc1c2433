// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/quality/regimes.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace ifog::bench {
namespace {

// In samples. Judging starts after five time constants of the filter. It lasts forty (at rest), eighty (in
// motion) or ten (started in motion) of them, but at least the minimum. In motion the mean of the variance is
// judged; before a motion is suspected its beginning contributes as much as six time constants of rest.
struct Lengths {
  std::size_t settle, rest, motion, started;
};

std::size_t time_constants(double ratio, double number) {
  return static_cast<std::size_t>(std::lround(number / std::sqrt(ratio)));
}

Lengths lengths(double ratio) {
  return {.settle = std::max<std::size_t>(20'000, time_constants(ratio, 5.0)),
          .rest = std::max<std::size_t>(128'000, time_constants(ratio, 40.0)),
          .motion = std::max<std::size_t>(80'000, time_constants(ratio, 80.0)),
          .started = std::max<std::size_t>(80'000, time_constants(ratio, 10.0))};
}

enum Stream : std::uint32_t { kWalk, kNoise, kMotion };

// Independent streams for any (regime, ratio, seed, stream).
class Streams {
 public:
  Streams(const std::string& regime, double ratio, std::uint64_t seed) : seed_(seed) {
    for (const char c : regime) name_.push_back(static_cast<unsigned char>(c));
    name_.push_back(static_cast<std::uint32_t>(std::lround(-1000.0 * std::log10(ratio))));
  }
  [[nodiscard]] Random operator()(Stream stream) const {
    std::vector<std::uint32_t> key{static_cast<std::uint32_t>(seed_),
                                   static_cast<std::uint32_t>(seed_ >> 32U), stream};
    key.insert(key.end(), name_.begin(), name_.end());
    std::seed_seq sequence(key.begin(), key.end());
    return Random(sequence);
  }

 private:
  std::uint64_t seed_;
  std::vector<std::uint32_t> name_;
};

RegimeRecord compose(const Streams& streams, double ratio, std::size_t from, Noise noise,
                     const std::vector<double>& motion) {
  RegimeRecord record;
  record.from = from;
  record.truth.resize(noise.size());
  record.measured.resize(noise.size());
  Random random = streams(kWalk);
  std::normal_distribution<double> step(0.0, std::sqrt(ratio));
  double walk = 0.0;
  for (std::size_t i = 0; i < record.truth.size(); ++i) {
    record.truth[i] = walk + (motion.empty() ? 0.0 : motion[i]);
    record.measured[i] = record.truth[i] + noise[i];
    walk += step(random);
  }
  return record;
}

using NoiseKind = std::function<Noise(Random&, std::size_t samples, std::size_t from)>;
using MotionKind = std::function<std::vector<double>(Random&, std::size_t samples, std::size_t from)>;

Regime at_rest(const std::string& name, double limit, NoiseKind noise) {
  return {.name = name,
          .limit = limit,
          .judge_variance = true,
          .make = [name, noise = std::move(noise)](double ratio, std::uint64_t seed) {
            const Streams streams(name, ratio, seed);
            const Lengths length = lengths(ratio);
            Random random = streams(kNoise);
            return compose(streams, ratio, length.settle,
                           noise(random, length.settle + length.rest, length.settle), {});
          }};
}

// judged: samples; 0: from the time constant.
Regime moving(const std::string& name, double limit, std::size_t judged, MotionKind motion) {
  return {.name = name,
          .limit = limit,
          .make = [name, judged, motion = std::move(motion)](double ratio, std::uint64_t seed) {
            const Streams streams(name, ratio, seed);
            const Lengths length = lengths(ratio);
            const std::size_t samples = length.settle + (judged > 0 ? judged : length.motion);
            Random of_noise = streams(kNoise), of_motion = streams(kMotion);
            return compose(streams, ratio, length.settle, gaussian_noise(of_noise, samples),
                           motion(of_motion, samples, length.settle));
          }};
}

// A motion that neither the conventional filter nor the raw rate distorts.
Regime borne(const std::string& name, bool slow, MotionKind motion) {
  Regime regime = moving(name, 1.05, 0, std::move(motion));
  regime.judge_variance = slow;
  regime.judge_against_raw = true;
  return regime;
}

// The level between two steps of the converter is uniform over consecutive seeds, because the error of the
// mean depends on it.
Regime quantised_regime(const std::string& name, double limit, double step) {
  Regime regime = at_rest(name, limit, nullptr);
  regime.make = [name, step](double ratio, std::uint64_t seed) {
    const Streams streams(name, ratio, seed);
    const Lengths length = lengths(ratio);
    Random of_noise = streams(kNoise);
    const double level = step * std::fmod(0.618034 * static_cast<double>(seed), 1.0);
    const std::size_t samples = length.settle + length.rest;
    RegimeRecord record = compose(streams, ratio, length.settle, gaussian_noise(of_noise, samples),
                                  std::vector<double>(samples, level));
    for (double& value : record.measured) value = quantised(value, step);
    return record;
  };
  return regime;
}

// Rest, then a drift of 1e-4 per sample until its lag has settled, then a step. Judged from the step on,
// while the conventional filter recovers.
Regime drift_then_step() {
  const std::string name = "drift-then-step";
  Regime regime = borne(name, false, nullptr);
  regime.make = [name](double ratio, std::uint64_t seed) {
    const Streams streams(name, ratio, seed);
    const std::size_t settle = lengths(ratio).settle;
    const std::size_t step = settle + std::max<std::size_t>(20'000, time_constants(ratio, 3.0));
    const std::size_t samples = step + std::max<std::size_t>(2'000, time_constants(ratio, 3.0));
    std::vector<double> motion = ramp(samples, settle, samples, 1e-4);
    for (std::size_t i = step; i < samples; ++i) motion[i] += 20.0;
    Random of_noise = streams(kNoise);
    return compose(streams, ratio, step, gaussian_noise(of_noise, samples), motion);
  };
  return regime;
}

// Two periods of a swing from the first sample on, then rest; judged a minute later.
Regime started_moving(const std::string& name, bool given) {
  return {.name = name,
          .limit = 1.1,
          .judge_variance = true,
          .noise_given = given,
          .make = [name](double ratio, std::uint64_t seed) {
            constexpr std::size_t kSwing = 20'000;
            constexpr auto kMinute = static_cast<std::size_t>(60.0 * kSampleRate_hz);
            const Streams streams(name, ratio, seed);
            const std::size_t samples = kSwing + kMinute + lengths(ratio).started;
            Random of_noise = streams(kNoise), of_motion = streams(kMotion);
            return compose(streams, ratio, kSwing + kMinute, gaussian_noise(of_noise, samples),
                           sway_that_ends(of_motion, samples, kSwing, 30.0, 0.02));
          }};
}

// Without given Q and R, as for a new sensor. A random walk is learned from the first part of the record, so
// the limits are 10 % wider. Colour of 0.9 at 200 Hz is below 4 Hz and cannot be distinguished from a
// vehicle's motion.
void add_untold(std::vector<Regime>& all) {
  const std::size_t given = all.size();
  for (std::size_t i = 0; i < given; ++i) {
    if (all[i].name != "gaussian" && all[i].name != "colour-0.5") continue;
    Regime learned = all[i];
    learned.name += "-untold";
    learned.limit *= 1.1;
    learned.noise_given = false;
    all.push_back(std::move(learned));
  }
}

void add_rest(std::vector<Regime>& all) {
  const auto independent = [](Noise (*kind)(Random&, std::size_t)) {
    return [kind](Random& random, std::size_t samples, std::size_t) { return kind(random, samples); };
  };
  all.push_back(at_rest("gaussian", 1.05, independent(gaussian_noise)));
  all.push_back(at_rest("student-t3", 1.1, independent(student_noise)));
  all.push_back(at_rest("skewed", 1.2, independent(skewed_noise)));
  all.push_back(at_rest("bimodal", 1.05, independent(bimodal_noise)));
  all.push_back(at_rest("missing-10%", 1.05, [](Random& random, std::size_t samples, std::size_t) {
    return missing_noise(random, samples, 0.1);
  }));
  all.push_back(at_rest("outliers-1%-20", 1.05, [](Random& random, std::size_t samples, std::size_t) {
    return outlier_noise(random, samples, 0.01, 20.0);
  }));
  // More noise than known is motion by default, so never worse than raw; smoothed if configured.
  for (const auto& [name, factor, limit] : {std::tuple{"noise-x5", 5.0, 1.5}, {"noise-x10", 10.0, 2.0}}) {
    all.push_back(at_rest(name, limit, [f = factor](Random& random, std::size_t samples, std::size_t from) {
      constexpr auto kTurn = static_cast<std::size_t>(40.0 * kSampleRate_hz);
      return changing_noise(random, samples, from, kTurn, f);
    }));
    all.back().wideband = "noise";
    Regime followed = all.back();
    followed.name += "-followed";
    followed.wideband = "motion";
    followed.limit = 1.05;
    followed.judge_raw_only = true;
    followed.judge_variance = false;
    all.push_back(std::move(followed));
  }
  for (const auto& [name, correlation, limit] :
       {std::tuple{"colour-0.5", 0.5, 1.1}, {"colour-0.9", 0.9, 1.5}, {"colour-0.98", 0.98, 1.5}})
    all.push_back(at_rest(name, limit, [c = correlation](Random& random, std::size_t samples, std::size_t) {
      return coloured_noise(random, samples, c);
    }));
  all.push_back(quantised_regime("quantised-5", 1.15, 5.0));
  add_untold(all);
}

// Slow: at most 0.02 σ per sample, the slope of a swing of 30 σ at 0.02 Hz.
void add_motion(std::vector<Regime>& all) {
  for (const auto& [name, slope] :
       {std::pair{"ramp-1e-4", 1e-4}, {"ramp-1e-3", 1e-3}, {"ramp-1e-2", 1e-2}, {"ramp-1e-1", 1e-1}})
    all.push_back(borne(name, slope < 0.02, [s = slope](Random&, std::size_t samples, std::size_t from) {
      return ramp(samples, from, from + (samples - from) * 3 / 4, s);
    }));
  all.push_back(drift_then_step());
  for (const auto& [name, hz] : {std::pair{"sea-", 0.1}, {"swing-", 0.02}})
    for (const int amplitude : {3, 30, 300})
      all.push_back(borne(name + std::to_string(amplitude), hz * amplitude < 0.61,
                          [a = amplitude, f = hz](Random& random, std::size_t samples, std::size_t from) {
                            return sway(random, samples, from, a, f);
                          }));
  for (const int rms : {1, 10})
    for (const int band_hz : {1, 10})
      all.push_back(borne("random-" + std::to_string(rms) + "-to-" + std::to_string(band_hz) + "Hz", false,
                          [rms, band_hz](Random& random, std::size_t samples, std::size_t from) {
                            return random_motion(random, samples, from, rms, band_hz);
                          }));
}

using Shaken = std::function<std::vector<double>(Random&, std::size_t samples, double per_hz)>;

// Motion from the first sample to the last. per_hz: factor on frequencies for a record whose sample rate
// differs from that of the motions.
void add_moving(std::vector<Regime>& all, const std::string& name, double sample_rate_hz, bool given,
                const Shaken& motion) {
  constexpr std::size_t kBegins = 50, kSamples = 30'000;
  Regime regime{.name = name + (given ? "" : "-untold"),
                .limit = 1.05,
                .judge_raw_only = true,
                .noise_given = given,
                .sample_rate_hz = sample_rate_hz,
                .make = [name, sample_rate_hz, motion](double ratio, std::uint64_t seed) {
                  const Streams streams(name, ratio, seed);
                  Random of_noise = streams(kNoise), of_motion = streams(kMotion);
                  return compose(streams, ratio, kBegins, gaussian_noise(of_noise, kSamples),
                                 motion(of_motion, kSamples, kSampleRate_hz / sample_rate_hz));
                }};
  all.push_back(std::move(regime));
}

// Vehicles and people at three sample rates, and records that begin in a swing.
void add_carried(std::vector<Regime>& all) {
  const auto sum = [](std::vector<double> a, const std::vector<double>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
    return a;
  };
  const std::vector<std::pair<std::string, Shaken>> kinds{
      {"vehicle",
       [sum](Random& random, std::size_t n, double per_hz) {
         return sum(random_motion(random, n, 0, 60.0, 0.5 * per_hz),
                    shaking(random, n, 8.0, 0.42 * kSampleRate_hz));
       }},
      {"rough-road",
       [](Random& random, std::size_t n, double) { return shaking(random, n, 40.0, 0.45 * kSampleRate_hz); }},
      {"ship",
       [sum](Random& random, std::size_t n, double per_hz) {
         return sum(sway(random, n, 0, 100.0, 0.1 * per_hz), shaking(random, n, 2.0, 0.42 * kSampleRate_hz));
       }},
      {"hand", [sum](Random& random, std::size_t n, double per_hz) {
         return sum(random_motion(random, n, 0, 30.0, 2.0 * per_hz),
                    random_motion(random, n, 0, 5.0, 4.0 * per_hz));
       }}};
  for (const auto& [name, motion] : kinds)
    for (const double hz : {10.0, 100.0, 200.0})
      for (const bool given : {true, false})
        add_moving(all, name + "-" + std::to_string(std::lround(hz)) + "Hz", hz, given, motion);
  for (const double amplitude : {3.0, 5.0, 10.0, 30.0})
    for (const auto& [frequency, shown] : {std::pair{0.05, "0.05"}, {0.2, "0.2"}, {1.0, "1"}})
      for (const bool given : {true, false})
        add_moving(all, "start-" + std::to_string(std::lround(amplitude)) + "-" + shown + "Hz",
                   kSampleRate_hz, given,
                   [a = amplitude, f = frequency](Random& random, std::size_t n, double) {
                     std::vector<double> rate = sway(random, n + n, 0, a, f);
                     // At full amplitude
                     rate.erase(rate.begin(), rate.begin() + static_cast<std::ptrdiff_t>(n));
                     return rate;
                   });
}

std::vector<Regime> make_regimes() {
  std::vector<Regime> all;
  add_rest(all);
  add_motion(all);
  all.push_back(moving("turns-30", 0.1, 40'000, [](Random&, std::size_t samples, std::size_t from) {
    return turns(samples, from, 30.0);
  }));
  all.push_back(moving("steps-20", 0.1, 40'000, [](Random& random, std::size_t samples, std::size_t from) {
    return steps(random, samples, from, 20.0);
  }));
  for (std::size_t i = all.size() - 2; i < all.size(); ++i) all[i].limit_at_laboratory = 0.3;
  add_carried(all);
  all.push_back(started_moving("started-moving", true));
  all.push_back(started_moving("started-moving-untold", false));
  return all;
}

}  // namespace

const std::vector<Regime>& regimes() {
  static const std::vector<Regime> all = make_regimes();
  return all;
}

double quantised(double value, double step) { return step * std::nearbyint(value / step); }

}  // namespace ifog::bench

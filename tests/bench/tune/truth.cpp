// SPDX-License-Identifier: Apache-2.0
// Tests `tune` with the true level, known only in a simulation. Tunes on one record and denoises another one
// of the same gyro with each fitted model, with the selected one and with none. Prints the error of the level
// relative to a Kalman filter with true parameters. Usage: tune_truth_bench [SEEDS [SAMPLES [FIRST [KIND]]]],
// 3 seeds of 60000 samples at 100 Hz.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "filters/chain/incrementer.h"
#include "filters/chain/signal_chain.h"
#include "filters/estimator/estimator.h"
#include "filters/tune/tune.h"

namespace {

constexpr double kPeriod = 0.01, kSigma = 1e-5, kOffset = 3e-5;

struct Kind {
  const char* name;
  double walk, phi, colour,
      flicker;  // Q/R; AR(1) coefficient and deviation over the white noise's; flicker's
};
constexpr Kind kKinds[] = {
    {"walk 1e-3", 1e-3, 0.0, 0.0, 0.0},
    {"walk 1e-5", 1e-5, 0.0, 0.0, 0.0},
    {"walk 1e-6", 1e-6, 0.0, 0.0, 0.0},
    {"walk 1e-7", 1e-7, 0.0, 0.0, 0.0},
    {"walk 1e-9", 1e-9, 0.0, 0.0, 0.0},
    {"ar(1) 0.5, walk 1e-6", 1e-6, 0.5, 1.0, 0.0},
    {"ar(1) 0.9, walk 1e-4", 1e-4, 0.9, 1.0, 0.0},
    {"ar(1) 0.9, walk 1e-6", 1e-6, 0.9, 1.0, 0.0},
    {"ar(1) 0.9, walk 1e-8", 1e-8, 0.9, 1.0, 0.0},
    {"flicker 0.01", 0.0, 0.0, 0.0, 0.01},
    {"flicker 0.1", 0.0, 0.0, 0.0, 0.1},
};

struct Record {
  std::vector<double> rate, level;
};

Record make(const Kind& kind, std::uint64_t seed, std::size_t samples) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Record out;
  double walk = kOffset, colour = kSigma * kind.colour * normal(engine);
  // Flicker as a sum of processes an octave apart with equal variance: 1/f from one sample to the whole
  // record.
  std::vector<double> octaves(kind.flicker > 0.0 ? 22 : 0);
  for (double& o : octaves) o = normal(engine);
  for (std::size_t k = 0; k < samples; ++k) {
    walk += kSigma * std::sqrt(kind.walk) * normal(engine);
    colour = kind.phi * colour + kSigma * kind.colour * std::sqrt(1.0 - kind.phi * kind.phi) * normal(engine);
    double level = walk;
    for (std::size_t o = 0; o < octaves.size(); ++o) {
      const double keep = std::exp(-std::ldexp(1.0, -static_cast<int>(o)));
      octaves[o] = keep * octaves[o] + std::sqrt(1.0 - keep * keep) * normal(engine);
      level += kSigma * kind.flicker * octaves[o];
    }
    out.level.push_back(level);
    out.rate.push_back(level + colour + kSigma * normal(engine));
  }
  return out;
}

double rmse(const std::vector<double>& estimate, const std::vector<double>& level) {
  const std::size_t from = level.size() / 6;
  double sum = 0.0;
  for (std::size_t k = from; k < level.size(); ++k)
    sum += (estimate[k] - level[k]) * (estimate[k] - level[k]);
  return std::sqrt(sum / static_cast<double>(level.size() - from));
}

// Level and colour as two states; white noise and random walk only if colour is 0.
std::vector<double> kalman(const std::vector<double>& rate, double q, double r, double phi, double colour) {
  std::vector<double> out;
  double x = rate[0], c = 0.0, pxx = r + colour, pxc = 0.0, pcc = colour;
  for (const double z : rate) {
    pxx += q;
    pxc *= phi;
    pcc = phi * phi * pcc + (1.0 - phi * phi) * colour;
    c *= phi;
    const double hx = pxx + pxc, hc = pxc + pcc, s = hx + hc + r, nu = z - x - c;
    x += hx / s * nu;
    c += hc / s * nu;
    pxx -= hx * hx / s;
    pxc -= hx * hc / s;
    pcc -= hc * hc / s;
    out.push_back(x);
  }
  return out;
}

double best_error(const Kind& kind, const Record& record) {
  const double r = kSigma * kSigma;
  if (kind.flicker <= 0.0)
    return rmse(kalman(record.rate, kind.walk * r, r, kind.phi, kind.colour * kind.colour * r), record.level);
  // Flicker has no finite exact filter: the best random walk for this record.
  double least = 1e300;
  for (double ln = -9.0; ln <= -1.0; ln += 0.25)
    least = std::min(least, rmse(kalman(record.rate, std::pow(10.0, ln) * r, r, 0.0, 0.0), record.level));
  return least;
}

double error_of(const ifog::FilterSettings& settings, const Record& record, double& normalised_square) {
  ifog::Estimator estimator(settings, 1, kPeriod);
  ifog::EstimatorInput in;
  ifog::EstimatorOutput out;
  in.dt_s = kPeriod;
  in.valid_axes = 1;
  std::vector<double> published;
  double normalised = 0.0, count = 0.0;
  for (std::size_t k = 0; k < record.rate.size(); ++k) {
    in.sequence = k;
    in.rate_radps[0] = record.rate[k];
    estimator.step(in, out);
    published.push_back(out.denoised_radps[0]);
    if (k < record.rate.size() / 6) continue;
    const double miss = published.back() - record.level[k];
    normalised += miss * miss / out.variance_rad2ps2[0];
    count += 1.0;
  }
  normalised_square = normalised / count;
  return rmse(published, record.level);
}

// Of the chain without settings, like denoise without a model.
double error_of_none(const Record& record) {
  ifog::ChainSettings settings;
  settings.facts.nominal_rate_hz = 1.0 / kPeriod;
  settings.axes = {""};
  ifog::SignalChain chain(std::make_unique<ifog::ChainParts>(settings));
  ifog::Incrementer incrementer(settings.facts);
  ifog::Increment increment;
  ifog::ChainOutput out;
  std::vector<double> published;
  for (std::size_t k = 0; k < record.rate.size(); ++k) {
    ifog::Reading reading;
    reading.device_time_ns = std::llround(1e9 * kPeriod * static_cast<double>(k));
    reading.valid_axes = 1;
    reading.value[0] = record.rate[k];
    incrementer.next(reading, increment);
    chain.process(increment, out);
    published.push_back(out.estimate.denoised_radps[0]);
  }
  return rmse(published, record.level);
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t seeds = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 3;
  const std::size_t samples = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 60000;
  const std::uint64_t first = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  std::printf("| record | seed | chosen | its NEES | random-walk | no model | chosen model |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  for (const Kind& kind : kKinds) {
    if (argc > 4 && std::string(kind.name).find(argv[4]) == std::string::npos) continue;
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
      const Record fitted = make(kind, seed, samples), next = make(kind, seed + 100000, samples);
      const std::span<const double> axes[] = {fitted.rate};
      ifog::TuneOptions options;
      options.threads = 1;
      const ifog::Tuning tuning = ifog::tune(axes, kPeriod, options);
      const double best = best_error(kind, next);
      const ifog::TunedModel& chosen = tuning.models[tuning.chosen];
      const auto walk = std::find_if(tuning.models.begin(), tuning.models.end(),
                                     [](const auto& m) { return m.settings.state == "random-walk"; });
      double normalised = 0.0;
      const double alone = error_of(walk->settings, next, normalised) / best;
      const double error = error_of(chosen.settings, next, normalised) / best;
      std::printf("| %s | %llu | %.3f | %.3g | %.3f | %.3f | %s |\n", kind.name,
                  static_cast<unsigned long long>(seed), error, normalised, alone, error_of_none(next) / best,
                  chosen.settings.state.c_str());
      std::fflush(stdout);
    }
  }
  return 0;
}

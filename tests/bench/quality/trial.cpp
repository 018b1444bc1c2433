// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/quality/trial.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "filters/chain/signal_chain.h"

namespace ifog::bench {
namespace {

// σ as a rate: 0.0024 °/√h at 200 Hz, a good fibre-optic gyro.
constexpr double kSigma_radps = 1e-5;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

ChainSettings chain_settings(const std::string& filter, double ratio, const Regime& regime) {
  ChainSettings settings;
  settings.facts.nominal_rate_hz = regime.sample_rate_hz;
  settings.axes = {""};
  settings.filter.wideband = regime.wideband;
  if (regime.noise_given) {
    settings.filter.measurement_noise = kSigma_radps * kSigma_radps;
    settings.filter.process_noise = ratio * kSigma_radps * kSigma_radps * regime.sample_rate_hz;
  }
  if (filter == "default") return settings;
  if (filter != "irwe-akfg-plain" && filter != "ckf")
    throw std::invalid_argument("filter \"" + filter + "\": expected default, irwe-akfg-plain or ckf");
  settings.filter.rule = filter == "ckf" ? "ckf" : "irwe-akfg";
  settings.filter.follow_manoeuvres = settings.filter.conserve_angle = false;
  return settings;
}

double rmse(const std::vector<double>& estimate, const RegimeRecord& record) {
  double sum = 0.0;
  for (std::size_t i = record.from; i < record.truth.size(); ++i)
    sum += std::pow(estimate[i] - record.truth[i], 2);
  const double value = std::sqrt(sum / static_cast<double>(record.truth.size() - record.from));
  return std::isfinite(value) ? value : kInfinity;
}

double rmse_of_raw(const RegimeRecord& record) {
  double sum = 0.0, present = 0.0;
  for (std::size_t i = record.from; i < record.truth.size(); ++i) {
    if (std::isnan(record.measured[i])) continue;
    sum += std::pow(record.measured[i] - record.truth[i], 2);
    present += 1.0;
  }
  return std::sqrt(sum / present);
}

double nees(const Filtered& estimate, const RegimeRecord& record) {
  double sum = 0.0;
  for (std::size_t i = record.from; i < record.truth.size(); ++i) {
    if (!(estimate.variance[i] > 0.0)) return kInfinity;
    sum += std::pow(estimate.value[i] - record.truth[i], 2) / estimate.variance[i];
  }
  const double value = sum / static_cast<double>(record.truth.size() - record.from);
  return std::isfinite(value) ? value : kInfinity;
}

}  // namespace

Filtered conventional(const RegimeRecord& record, double ratio, bool informed) {
  Filtered out;
  double x = 0.0, p = 0.0;
  bool started = false;
  for (std::size_t i = 0; i < record.measured.size(); ++i) {
    const double r = informed && !record.noise_variance.empty() ? record.noise_variance[i] : 1.0;
    const double z = record.measured[i];
    if (informed && record.rest_from == i) started = false;
    p += ratio;
    if (std::isfinite(z) && !started) {
      x = z;
      p = r;
      started = true;
    } else if (std::isfinite(z)) {
      const double gain = p / (p + r);
      x += gain * (z - x);
      p *= 1.0 - gain;
    }
    out.value.push_back(x);
    out.variance.push_back(p);
  }
  return out;
}

Filtered denoised(const std::string& filter, const RegimeRecord& record, double ratio, const Regime& regime) {
  const double period_s = 1.0 / regime.sample_rate_hz;
  SignalChain chain(std::make_unique<ChainParts>(chain_settings(filter, ratio, regime)));
  Increment in;
  ChainOutput estimate;
  Filtered out;
  in.dt_s = period_s;
  for (const double measured : record.measured) {
    const bool valid = std::isfinite(measured);
    in.valid_axes = valid ? 1 : 0;
    in.flags = valid ? 0U : static_cast<std::uint32_t>(kInvalid);
    in.rate_radps[0] = measured * kSigma_radps;
    in.covered_s[0] = valid ? period_s : 0.0;
    in.delta_theta_rad[0] = valid ? in.rate_radps[0] * period_s : 0.0;
    chain.process(in, estimate);
    ++in.sequence;
    out.value.push_back(estimate.estimate.denoised_radps[0] / kSigma_radps);
    out.variance.push_back(estimate.estimate.variance_rad2ps2[0] / (kSigma_radps * kSigma_radps));
  }
  return out;
}

const std::vector<std::string>& filter_names() {
  static const std::vector<std::string> names{"default", "irwe-akfg-plain", "ckf"};
  return names;
}

Figures judge(const Regime& regime, const std::string& filter, double ratio, std::uint64_t seed) {
  const RegimeRecord record = regime.make(ratio, seed);
  const Filtered reference = conventional(record, ratio, false);
  const Filtered got = denoised(filter, record, ratio, regime);
  const double error = rmse(got.value, record), usual = rmse(reference.value, record);
  Figures figures;
  figures.over_conventional = error / usual;
  figures.over_better = error / std::min(usual, rmse_of_raw(record));
  figures.over_raw = error / rmse_of_raw(record);
  figures.over_informed = record.noise_variance.empty() && !record.rest_from
                              ? std::nan("")
                              : error / rmse(conventional(record, ratio, true).value, record);
  figures.nees = nees(got, record);
  figures.nees_conventional = nees(reference, record);
  figures.settle = record.from;
  figures.judged = record.truth.size() - record.from;
  return figures;
}

}  // namespace ifog::bench

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/undeclared/oracle_diagnosis.h"

#include <Eigen/Dense>
#include <cmath>

namespace ifog::undeclared {
namespace {

Eigen::MatrixXd whitened_columns(const Sensor& s, std::vector<double>& z) {
  const std::size_t n = s.samples, captures = static_cast<std::size_t>(s.captures);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n * captures),
                                            static_cast<Eigen::Index>(s.effects.size() + captures));
  const auto put = [&](std::size_t capture, std::size_t column, const std::vector<double>& values) {
    const std::vector<double> w = s.noise_model->whiten(values);
    for (std::size_t k = 0; k < n; ++k)
      A(static_cast<Eigen::Index>(capture * n + k), static_cast<Eigen::Index>(column)) = w[k];
  };
  for (std::size_t c = 0; c < captures; ++c) {
    const Record r = record(s, static_cast<int>(c));
    std::vector<double> error = r.capture.rate_radps[0];
    if (s.range.has_reference)
      for (std::size_t k = 0; k < n; ++k) error[k] -= r.capture.reference_rate_radps[0][k];
    const std::vector<double> w = s.noise_model->whiten(error);
    z.insert(z.end(), w.begin(), w.end());
    for (std::size_t e = 0; e < s.effects.size(); ++e) {
      std::vector<double> unit = r.effects[e];
      for (double& value : unit) value /= s.effects[e].size;
      put(c, e, unit);
    }
    put(c, s.effects.size() + c, std::vector<double>(n, 1.0));
  }
  return A;
}

}  // namespace

Diagnose oracle_diagnosis(const Sensor& sensor) {
  return [sensor](const std::vector<Capture>&) {
    std::vector<double> z;
    const Eigen::MatrixXd A = whitened_columns(sensor, z);
    const Eigen::Map<const Eigen::VectorXd> b(z.data(), static_cast<Eigen::Index>(z.size()));
    const Eigen::MatrixXd covariance = (A.transpose() * A).inverse();
    const Eigen::VectorXd x = covariance * (A.transpose() * b);
    Finding finding;
    finding.unexplained = sensor.kind == Kind::kUncovered;
    for (std::size_t e = 0; e < sensor.effects.size(); ++e) {
      const auto i = static_cast<Eigen::Index>(e);
      const TrueEffect& truth = sensor.effects[e];
      Claim found;
      found.effect.form = truth.form;
      found.effect.channel = truth.channel;
      found.effect.with_form = truth.with_form;
      found.effect.with_channel = truth.with_channel;
      found.effect.parameters = {{"coefficient", x(i), std::sqrt(covariance(i, i)), ""}};
      const double ratio = x(i) / truth.size;
      found.waveform = [sensor, e, ratio](const Capture& capture) {
        for (const int number : {0, 1, 2, 50}) {
          Record r = record(sensor, number);
          if (r.capture.rate_radps[0] != capture.rate_radps[0]) continue;
          for (double& value : r.effects[e]) value *= ratio;
          return r.effects[e];
        }
        return std::vector<double>(sensor.samples, 0.0);
      };
      finding.effects.push_back(std::move(found));
    }
    return finding;
  };
}

Diagnose blind_diagnosis() {
  return [](const std::vector<Capture>&) { return Finding{}; };
}

}  // namespace ifog::undeclared

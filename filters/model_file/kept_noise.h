// SPDX-License-Identifier: Apache-2.0
// Noise of a sensor learned by the daemon, stored for the next start. Only the daemon writes it; a model's
// values override it.
//
//   schema = "ifog.noise/2"
//   sensor = "nose"
//   driver = "kvh1750"
//   axes = 3
//   sample_rate_hz = 1000
//   learned = "2026-01-31T13:05:09Z"   # end of the last rest used
//   model = "3f9c21a0b7de"            # identity of the model that corrected the rate; "": none
//   process_noise = 1.2e-15            # of a random walk, (rad/s)^2/s
//   measurement_noise = 3.1e-10        # per sample, (rad/s)^2
//   noise = [3.0e-10, 3.1e-10, 3.2e-10]  # per axis
//   samples = 8192000                  # at rest
#pragma once

#include <string>
#include <string_view>

#include "filters/estimator/learned_noise.h"

namespace ifog {

struct KeptNoise {
  std::string sensor, driver;
  int axes = 1;
  double sample_rate_hz = 0.0;  // nominal
  std::string learned;          // UTC, ISO 8601
  LearnedNoise noise;
};

[[nodiscard]] std::string kept_noise_text(const KeptNoise& kept);
// These throw std::runtime_error with one line: file:line: error.
[[nodiscard]] KeptNoise parse_kept_noise(std::string_view text, const std::string& name);
[[nodiscard]] KeptNoise read_kept_noise(const std::string& path);

}  // namespace ifog

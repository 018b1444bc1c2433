// SPDX-License-Identifier: Apache-2.0
// Learned noise of a sensor over restarts: NAME.noise.toml in the state folder, read before the signal chain
// is built and written from time to time. Errors are only remarks.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/ifog/driver.h"
#include "filters/chain/signal_chain.h"
#include "filters/model_file/kept_noise.h"

namespace ifog {

// Name of the file, in the state folder and in flight recordings.
[[nodiscard]] inline std::string noise_file_name(const std::string& sensor) { return sensor + ".noise.toml"; }

class NoiseMemory {
 public:
  NoiseMemory() = default;
  // folder "": nothing is read or stored.
  NoiseMemory(const std::string& folder, const std::string& sensor, const std::string& driver,
              const SensorFacts& facts);

  // Noise learned by an earlier run; nullopt if there is none, or of another sensor.
  [[nodiscard]] const std::optional<LearnedNoise>& recalled() const noexcept { return recalled_; }
  // Remark about the file, or ""; good: it is in use.
  [[nodiscard]] const std::string& remark() const noexcept { return remark_; }
  [[nodiscard]] bool good() const noexcept { return recalled_.has_value(); }

  // Text of the file with this noise, or "".
  [[nodiscard]] std::string text(const std::optional<LearnedNoise>& learned) const;

  // Writes new values, ten minutes after the last time or at once. now_ns: monotonic. Returns an error once
  // until the next success; else "".
  std::string keep(const LearnedNoise& learned, std::int64_t now_ns, bool at_once);

 private:
  std::string path_;  // "": nothing is stored
  KeptNoise kept_;
  std::optional<LearnedNoise> recalled_;
  std::string remark_;
  double written_samples_ = 0.0;
  std::optional<std::int64_t> tried_ns_;
  bool failed_ = false;
};

}  // namespace ifog

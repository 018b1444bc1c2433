// SPDX-License-Identifier: Apache-2.0
// The noise of a sensor over restarts: read before its signal chain is built, written now and then while it
// runs, in the state folder as NAME.noise.toml. One that cannot be read or written is a remark, never a
// reason not to run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/ifog/driver.h"
#include "filters/chain/signal_chain.h"
#include "filters/model_file/kept_noise.h"

namespace ifog {

// The file's name, in the state folder as in a flight recording.
[[nodiscard]] inline std::string noise_file_name(const std::string& sensor) { return sensor + ".noise.toml"; }

class NoiseMemory {
 public:
  NoiseMemory() = default;
  // folder "": nothing is read or kept.
  NoiseMemory(const std::string& folder, const std::string& sensor, const std::string& driver,
              const SensorFacts& facts);

  // What an earlier run has learned of this sensor; nothing where there is none, or of another one.
  [[nodiscard]] const std::optional<LearnedNoise>& recalled() const noexcept { return recalled_; }
  // What is to be said of the file that was found, "" for nothing; good: it is in use.
  [[nodiscard]] const std::string& remark() const noexcept { return remark_; }
  [[nodiscard]] bool good() const noexcept { return recalled_.has_value(); }

  // The file's text with these figures in it; "" for none.
  [[nodiscard]] std::string text(const std::optional<LearnedNoise>& learned) const;

  // Writes what is new, ten minutes after the last time or, at the end of a run, at once. now_ns: monotonic.
  // Gives a complaint, once until it has succeeded again; "" for none.
  std::string keep(const LearnedNoise& learned, std::int64_t now_ns, bool at_once);

 private:
  std::string path_;  // "": nothing is kept
  KeptNoise kept_;
  std::optional<LearnedNoise> recalled_;
  std::string remark_;
  double written_samples_ = 0.0;
  std::optional<std::int64_t> tried_ns_;
  bool failed_ = false;
};

}  // namespace ifog

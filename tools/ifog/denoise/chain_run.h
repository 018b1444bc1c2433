// SPDX-License-Identifier: Apache-2.0
// Runs the daemon's chain over the samples of one sensor; restarts it and exchanges its parts where the
// daemon did.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/host/driver_instance.h"
#include "tools/ifog/denoise/offline_chain.h"

namespace ifog::tools {

// Settings for a driver's samples. path: of the recording, for messages. Throws std::runtime_error with one
// line if the sample rate is unknown.
[[nodiscard]] ChainSettings recording_settings(const OfflineSettings& settings, const DriverInstance& driver,
                                               const std::string& path);

class ChainRun {
 public:
  // Throws std::runtime_error with one line; names the file if the model is wrong.
  ChainRun(const ChainSettings& settings, const OfflineSettings& offline);
  // Starts as the daemon does.
  void begin(const ChainSettings& settings);
  // Uses other settings from the next sample on, as the daemon does.
  void exchange(const ChainSettings& settings);
  // Null: the sample is a duplicate or out of order.
  const Increment* run(const Reading& reading, ChainOutput& out);
  // Says if the samples since the last call count in the result.
  void count(bool counts);
  void discontinuity() { incrementer_->discontinuity(); }
  OfflineResult finish();

 private:
  void describe();

  std::string model_path_;
  std::optional<Incrementer> incrementer_;
  std::optional<SignalChain> chain_;
  Increment increment_;
  std::optional<std::uint64_t> first_sequence_;
  std::uint64_t sequence_shift_ = 0;
  OfflineResult result_;
  IncrementerCounts counted_;  // of this incrementer, by count()
  bool counts_ = true;         // for the last sample
};

}  // namespace ifog::tools

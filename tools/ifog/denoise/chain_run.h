// SPDX-License-Identifier: Apache-2.0
// The chain as the daemon runs it, over what was recorded of one sensor: restarted where the daemon started,
// its parts exchanged where it exchanged them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/host/driver_instance.h"
#include "tools/ifog/denoise/offline_chain.h"

namespace ifog::tools {

// Settings for a driver's samples. path: the recording's, for messages. Throws std::runtime_error with one line where
// nobody knows the sample rate.
[[nodiscard]] ChainSettings recording_settings(const OfflineSettings& settings, const DriverInstance& driver,
                                               const std::string& path);

class ChainRun {
 public:
  // Throws std::runtime_error with one line, of the model with its file.
  ChainRun(const ChainSettings& settings, const OfflineSettings& offline);
  // As the daemon starts.
  void begin(const ChainSettings& settings);
  // As it takes other settings into use, from the next sample on.
  void exchange(const ChainSettings& settings);
  // Null: the sample is a duplicate, or a later one had arrived.
  const Increment* run(const Reading& reading, ChainOutput& out);
  // Whether what has come since the last call counts in the result.
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
  bool counts_ = true;         // the last sample
};

}  // namespace ifog::tools

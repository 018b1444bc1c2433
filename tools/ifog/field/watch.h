// SPDX-License-Identifier: Apache-2.0
// Observes a sensor after an exchange of its model: notices of the daemon, and the gain compared with the
// predicted one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/ifog/field/exchange.h"
#include "tools/ifog/field/recorded.h"

namespace ifog::tools {

struct Watched {
  double seconds = 0.0;
  bool whole = true;  // not interrupted
  std::uint64_t statuses = 0;
  std::int64_t divergences = 0, gated = 0;  // increase during the watch
  std::string noticed;                      // the daemon's last notice, "" if none
  std::vector<double> nis, whiteness;       // by axis, means over the watch
  std::vector<AxisGain> gain;               // from the recording
  std::string not_weighed;                  // why gain is empty
};

// Observes for `seconds`, then evaluates the recording. recorded_before: number of the last recording that
// was started before the exchange; a reload starts a new one.
[[nodiscard]] Watched watch(LiveStatus& live, const Field& field, const SensorConfig& sensor,
                            const Model& before, const Model& after, std::uint64_t recorded_before,
                            double seconds);

// "the promise came true: …".
[[nodiscard]] std::string outcome(const Watched& watched);

}  // namespace ifog::tools

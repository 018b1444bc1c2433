// SPDX-License-Identifier: Apache-2.0
// Looks on after a model was exchanged: what the daemon notices meanwhile, and whether the promise comes
// true.
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
  std::int64_t divergences = 0, gated = 0;  // more than before
  std::string noticed;                      // the last notice of the daemon, "" if none
  std::vector<double> nis, whiteness;       // by axis, means over the watch
  std::vector<AxisGain> gain;               // from the recording
  std::string not_weighed;                  // why gain is empty
};

// As long as `seconds`; the recording then tells. recorded_before: number of the last recording that was
// begun before the exchange; a reload begins a new one.
[[nodiscard]] Watched watch(LiveStatus& live, const Field& field, const SensorConfig& sensor,
                            const Model& before, const Model& after, std::uint64_t recorded_before,
                            double seconds);

// "the promise came true: …".
[[nodiscard]] std::string outcome(const Watched& watched);

}  // namespace ifog::tools

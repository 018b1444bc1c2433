// SPDX-License-Identifier: Apache-2.0
// What a test makes a capture of.
#pragma once

#include "filters/diagnosis/record.h"
#include "filters/random/philox.h"
#include "tests/unit/test.h"

namespace ifog {

// Standard normal deviates by their place, so that each sensor that a test makes is the same on every machine
// (Box and Muller, Annals of Mathematical Statistics 29, 1958, over Philox).
inline double gaussian_deviate(std::uint32_t counter, std::uint32_t stream, std::uint32_t seed,
                               std::uint32_t test) {
  const PhiloxBlock bits = philox({counter, stream, 0, 0}, {seed, test});
  const double u = (bits[0] + 0.5) / 4294967296.0;
  const double v = (bits[1] + 0.5) / 4294967296.0;
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

// A capture of arrays that a test has made and keeps alive; reference: none unless it is given.
inline Record made_record(std::string name, std::span<const double> time_s,
                          std::span<const double> rate_radps, std::vector<RecordChannel> channels = {},
                          std::span<const double> reference_radps = {}) {
  Record record;
  record.name = std::move(name);
  record.time_s = time_s;
  record.rate_radps = rate_radps;
  record.reference_radps = reference_radps;
  record.channels = std::move(channels);
  return record;
}

}  // namespace ifog

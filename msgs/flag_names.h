// SPDX-License-Identifier: Apache-2.0
// Names of the flags of rate_t.
#pragma once

#include <array>
#include <cstdint>
#include <ifog/rate_t.hpp>
#include <string_view>

namespace ifog {

struct FlagName {
  std::int32_t flag;
  std::string_view name;
};

inline constexpr std::array<FlagName, 17> kFlagNames{{{rate_t::FLAG_AT_REST, "at rest"},
                                                      {rate_t::FLAG_MANOEUVRE, "manoeuvre"},
                                                      {rate_t::FLAG_NOISE_UNKNOWN, "noise not yet known"},
                                                      {rate_t::FLAG_GAP, "gap"},
                                                      {rate_t::FLAG_MERGED, "merged"},
                                                      {rate_t::FLAG_INVALID, "invalid"},
                                                      {rate_t::FLAG_SATURATED, "saturated"},
                                                      {rate_t::FLAG_STUCK, "stuck"},
                                                      {rate_t::FLAG_GATED, "gated"},
                                                      {rate_t::FLAG_FILTER_RESET, "filter reset"},
                                                      {rate_t::FLAG_STALE_CHANNEL, "channel stale"},
                                                      {rate_t::FLAG_OUT_OF_RANGE, "out of the model's range"},
                                                      {rate_t::FLAG_RAMP_UNKNOWN, "ramp's phase not known"},
                                                      {rate_t::FLAG_NOT_COMPENSATED, "not compensated"},
                                                      {rate_t::FLAG_BEYOND_STATED, "beyond the stated range"},
                                                      {rate_t::FLAG_CLOCK_STEP, "clock step"},
                                                      {rate_t::FLAG_SENSOR_CLOCK_SET, "sensor's clock set"}}};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// Flags of rate_t and imu_t from the chain's flags.
#pragma once

#include <cstdint>
#include <ifog/rate_t.hpp>

#include "filters/chain/signal_chain.h"

namespace ifog {

inline std::int32_t message_flags(const Increment& in, const ChainOutput& out) noexcept {
  std::int32_t flags = 0;
  const auto pass = [&flags](std::uint32_t set, std::uint32_t bit, std::int32_t flag) {
    if ((set & bit) != 0) flags |= flag;
  };
  pass(in.flags, kGapBefore, rate_t::FLAG_GAP);
  pass(in.flags, kMerged, rate_t::FLAG_MERGED);
  pass(in.flags, kInvalid, rate_t::FLAG_INVALID);
  pass(in.flags, kClockStep, rate_t::FLAG_CLOCK_STEP);
  pass(in.flags, kSensorClockSet, rate_t::FLAG_SENSOR_CLOCK_SET);
  pass(in.flags, kBeyondStated, rate_t::FLAG_BEYOND_STATED);
  pass(in.flags, kAtFullScale, rate_t::FLAG_SATURATED);
  pass(out.compensator_flags, kStaleChannel | kNoChannelYet, rate_t::FLAG_STALE_CHANNEL);
  pass(out.compensator_flags, kOutOfRange, rate_t::FLAG_OUT_OF_RANGE);
  pass(out.compensator_flags, kRampUnknown, rate_t::FLAG_RAMP_UNKNOWN);
  pass(out.flags, kNoiseUnknown, rate_t::FLAG_NOISE_UNKNOWN);
  pass(out.flags, kFilterReset, rate_t::FLAG_FILTER_RESET);
  pass(out.flags, kNotCompensated, rate_t::FLAG_NOT_COMPENSATED);
  pass(out.estimate.flags, kGated, rate_t::FLAG_GATED);
  pass(out.estimate.flags, kManoeuvre, rate_t::FLAG_MANOEUVRE);
  pass(out.estimate.flags, kRestarted, rate_t::FLAG_FILTER_RESET);
  pass(out.estimate.flags, kStuck, rate_t::FLAG_STUCK);
  pass(out.estimate.flags, kAtRest, rate_t::FLAG_AT_REST);
  return flags;
}

}  // namespace ifog

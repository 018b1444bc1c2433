// SPDX-License-Identifier: Apache-2.0
// From the chain's output to the bytes of an ifog.imu_t, in a buffer of its own, without allocation. What
// could not be sent is in the next message: who integrates them has every increment once.
#pragma once

#include <cstdint>
#include <ifog/imu_t.hpp>
#include <span>
#include <vector>

#include "filters/chain/signal_chain.h"

namespace ifog {

class ImuEncoder {
 public:
  // `temperature_channel`: of the sensor's frames, in °C; -1: none.
  explicit ImuEncoder(int temperature_channel);

  // This increment, behind those that were not sent. Valid until the next call.
  std::span<const std::uint8_t> encode(const Increment& in, const ChainOutput& out) noexcept;
  // What became of the message; false: the next one has its increments, too.
  void sent(bool good) noexcept { waits_ = !good; }

 private:
  ifog::imu_t message_;
  int temperature_channel_;
  std::vector<std::uint8_t> buffer_;
  bool waits_ = false;  // message_ holds what was not sent
};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// Encodes the chain's output in buffers of their own, without allocation: ifog.rate_t, and further messages of a
// sensor with three gyros and three accelerometers (this project's types, or those of other programs on LCM).
#pragma once

#include <cstdint>
#include <ifog/rate_t.hpp>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "daemon/config/config.h"
#include "filters/chain/signal_chain.h"

namespace ifog {

class RateEncoder {
 public:
  explicit RateEncoder(int axes);

  // Allocates if the identity changes (a reload).
  void use(const ChainParts& parts);
  // Valid until the next call.
  std::span<const std::uint8_t> encode(const Increment& in, const ChainOutput& out,
                                       const ChainParts& parts) noexcept;

 private:
  ifog::rate_t message_;
  std::vector<std::uint8_t> buffer_;
};

class InertialEncoder {
 public:
  virtual ~InertialEncoder() = default;
  // Message of this increment; empty if the type cannot express it. Valid until the next call.
  virtual std::span<const std::uint8_t> encode(const Increment& in, const ChainOutput& out) noexcept = 0;
  // Result of sending. For this project's types the next message includes unsent increments, so that
  // integration is complete.
  virtual void sent(bool good) noexcept { (void)good; }
};

// type: one of config.h. Rates are compensated and unfiltered, mean of the sample. Types of other
// programs have no flags: samples with an invalid axis are not sent, and are missing in a batch.
std::unique_ptr<InertialEncoder> make_inertial_encoder(std::string_view type, const SensorFacts& facts);

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// From the chain's output to the bytes of a message besides rate_t, of a sensor with three gyros and three
// accelerometers: one of ours, or one that other programs on LCM know. In buffers of their own, without
// allocation.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "daemon/config/published_type.h"
#include "filters/chain/signal_chain.h"

namespace ifog {

class InertialEncoder {
 public:
  virtual ~InertialEncoder() = default;
  // The message for this increment; empty: the type cannot say it, and nothing is to be sent. Valid until the next call.
  virtual std::span<const std::uint8_t> encode(const Increment& in, const ChainOutput& out) noexcept = 0;
  // What became of the message. Of ours that are not sent the next one has the increments, too: who
  // integrates them has every increment once.
  virtual void sent(bool good) noexcept { (void)good; }
};

// `type`: one of published_type.h. Rates are compensated and unfiltered, the mean of the sample. The types of other
// programs have no flags: of a sample with an axis that is invalid none is sent, and a batch is without it.
std::unique_ptr<InertialEncoder> make_inertial_encoder(std::string_view type, const SensorFacts& facts);

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// One channel of a type of peer_types.h, as the messages that our readers of logs work on.
#pragma once

#include <cstdint>
#include <functional>
#include <ifog/rate_t.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/ifog/captures/lcm/peer_types.h"

namespace ifog::tools {

// A rate and what was measured with it, by PeerReader::beside().
struct MeasuredRate : rate_t {
  std::vector<double> beside;
};

class PeerReader {
 public:
  explicit PeerReader(const PeerType& type) : type_(&type) {}

  [[nodiscard]] const PeerType& type() const { return *type_; }
  // Columns of specific force and temperature, where the type has them.
  [[nodiscard]] std::vector<std::string> beside() const;

  // The first look at every message of the channel: the sensor's period, and whether its clock is one.
  void look_at(std::span<const std::uint8_t> message);
  // The second: the samples that were in no message before, in the order of their counts. An angle that a
  // packet turned is divided by the period, so that the jitter of stamps is no noise of the rate. False: the
  // message is none of the type.
  bool take(std::span<const std::uint8_t> message, const std::function<void(MeasuredRate&&)>& sink);

 private:
  struct Place {
    std::int64_t count, utime, device_ns;
  };
  bool unpack(std::span<const std::uint8_t> message);  // into samples_
  [[nodiscard]] std::int64_t unwrapped(const PeerSample& sample) const;
  bool again(const PeerSample& sample);
  [[nodiscard]] double period_s();

  const PeerType* type_;
  std::vector<PeerSample> samples_;
  std::optional<Place> first_, last_;
  std::vector<double> steps_us_;  // between samples that follow one another
  double advance_us_ = 0.0, device_advance_us_ = 0.0;
  std::optional<double> period_s_;
  bool second_look_ = false;
  double angle_ = PeerSample::kUnknown;
};

}  // namespace ifog::tools

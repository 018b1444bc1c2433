// SPDX-License-Identifier: Apache-2.0
// Number of an LCM message used for an environment channel.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "daemon/config/lcm_field_name.h"

namespace ifog {

// True if the bytes are one complete message of a type that carries fields.
bool is_message(std::span<const std::uint8_t> bytes);

class LcmField {
 public:
  // Field by name: "NAME": the ifog.channel_t of that name, or a number of an ifog.status_t: input_rate_hz, …
  // "FIELD[i]": of an ifog.rate_t raw, compensated, denoised; of an ifog.status_t nis_mean, whiteness,
  //   measurement_noise; i = 0 … 2.
  // "channel_value[NAME]": another sensor's channel, from its ifog.status_t. The configuration refuses what
  // is none of these.
  explicit LcmField(const std::string& text) : field_(LcmFieldName::parse(text).value()) {}

  // False: invalid message, another type, or without the field. The type is recognised by LCM's fingerprint.
  // utime: of the measurement, µs since the epoch, 0 if unknown.
  bool read(std::span<const std::uint8_t> message, double& value, std::int64_t& utime) const;

 private:
  bool read_rate(std::span<const std::uint8_t> message, double& value, std::int64_t& utime) const;
  bool read_status(std::span<const std::uint8_t> message, double& value, std::int64_t& utime) const;

  LcmFieldName field_;
};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/rate_encoder.h"

#include <algorithm>

#include "daemon/publish/message_flags.h"

namespace ifog {
namespace {

constexpr std::size_t kLongestIdentity = 64;

}  // namespace

RateEncoder::RateEncoder(int axes) : message_() {
  const auto n = static_cast<std::size_t>(axes);
  message_.axes = static_cast<std::int8_t>(axes);
  for (auto* field : {&message_.raw, &message_.compensated, &message_.denoised, &message_.variance,
                      &message_.delta_theta, &message_.covered, &message_.angle, &message_.innovation,
                      &message_.innovation_variance, &message_.gain})
    field->resize(n);
  message_.model.reserve(kLongestIdentity);
  buffer_.resize(static_cast<std::size_t>(message_.getEncodedSize()) + kLongestIdentity);
}

void RateEncoder::use(const ChainParts& parts) {
  message_.model = parts.model_identity().substr(0, kLongestIdentity);
}

std::span<const std::uint8_t> RateEncoder::encode(const Increment& in, const ChainOutput& out,
                                                  const ChainParts& parts) noexcept {
  message_.utime = in.utime_ns / 1000;
  message_.seq = static_cast<std::int64_t>(in.sequence);
  message_.sensor_time_ns = in.device_time_ns;
  message_.arrival_ns = in.arrival_ns != 0 ? in.arrival_ns + in.wall_shift_ns : 0;
  message_.dt = in.dt_s;
  message_.merged = static_cast<std::int32_t>(in.samples);
  message_.flags = message_flags(in, out);
  message_.status = static_cast<std::int32_t>(in.status);
  const auto copy = [n = message_.raw.size()](const Axes& from, std::vector<double>& to) {
    std::copy_n(from.begin(), n, to.begin());
  };
  copy(in.rate_radps, message_.raw);
  copy(out.compensated_radps, message_.compensated);
  copy(out.estimate.denoised_radps, message_.denoised);
  copy(out.estimate.variance_rad2ps2, message_.variance);
  copy(out.delta_theta_rad, message_.delta_theta);
  copy(in.covered_s, message_.covered);
  copy(out.angle_rad, message_.angle);
  copy(out.estimate.innovation_radps, message_.innovation);
  copy(out.estimate.innovation_variance, message_.innovation_variance);
  copy(out.estimate.gain, message_.gain);
  const EstimatorHealth* const health = parts.health();
  message_.group_delay = health != nullptr ? health->group_delay_s : 0.0;
  message_.correlation_time = health != nullptr ? health->correlation_time_s : 0.0;
  const int size = message_.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
  return {buffer_.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

}  // namespace ifog

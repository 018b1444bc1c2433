// SPDX-License-Identifier: Apache-2.0
// Messages of each type, and their bytes.
#pragma once

#include <cmath>
#include <cstdint>
#include <ifog/channel_t.hpp>
#include <ifog/rate_t.hpp>
#include <ifog/status_t.hpp>
#include <string>
#include <vector>

namespace ifog {

template <typename Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(out.data(), 0, static_cast<int>(out.size()));
  return out;
}

inline channel_t channel(const std::string& name, double value, std::int64_t utime = 0) {
  channel_t out{};
  out.name = name;
  out.value = value;
  out.utime = utime;
  return out;
}

// Each field with numbers of its own, from `next` on.
inline rate_t rate(int axes = 2, double next = 1.0) {
  rate_t out{};
  out.utime = 7;
  out.axes = static_cast<std::int8_t>(axes);
  for (auto* field : {&out.raw, &out.compensated, &out.denoised, &out.variance, &out.delta_theta,
                      &out.covered, &out.angle, &out.innovation, &out.innovation_variance, &out.gain})
    for (int axis = 0; axis < axes; ++axis) field->push_back(next++);
  return out;
}

inline status_t status() {
  status_t out{};
  out.utime = 5'000'000;
  out.clock_offset_ppm = -12.5;
  out.latency_p99_us = 88.0;
  out.axes = 1;
  out.nis_mean = {1.1};
  out.whiteness = {0.2};
  out.measurement_noise = {3e-9};
  out.channels = 2;
  out.channel_name = {"supply_V", "temperature_degC"};
  out.channel_value = {12.0, 41.5};
  out.channel_age_s = {INFINITY, 2.0};
  out.allan_rate_radps.resize(1);
  return out;
}

}  // namespace ifog

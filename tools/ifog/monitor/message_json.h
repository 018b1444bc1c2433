// SPDX-License-Identifier: Apache-2.0
// A message of the daemon as one line of JSON, schema "ifog.monitor/1", with the field names of its type. NaN
// and infinity are null.
#pragma once

#include <ifog/imu_t.hpp>
#include <ifog/rate_t.hpp>
#include <ifog/status_t.hpp>
#include <string>
#include <string_view>

namespace ifog::tools {

// "sensor" is the channel's name without IFOG_, "type" is "rate", "status" or "imu". No line end.
std::string message_json(std::string_view sensor, const rate_t& message);
std::string message_json(std::string_view sensor, const status_t& message);
std::string message_json(std::string_view sensor, const imu_t& message);

}  // namespace ifog::tools

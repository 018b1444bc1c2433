// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/monitor/message_json.h"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "msgs/counters.h"
#include "msgs/flag_names.h"
#include "msgs/state_name.h"
#include "tools/ifog/console/json.h"

namespace ifog::tools {
namespace {

using nlohmann::ordered_json;

ordered_json of(const char* type, std::string_view sensor) {
  return {{"schema", "ifog.monitor/1"}, {"type", type}, {"sensor", sensor}};
}

// Of rate_t and imu_t.
template <typename Message>
ordered_json of_samples(const char* type, std::string_view sensor, const Message& message) {
  ordered_json out = of(type, sensor), words = ordered_json::array();
  for (const FlagName& each : kFlagNames)
    if ((message.flags & each.flag) != 0) words.push_back(each.name);
  out["utime"] = message.utime;
  out["seq"] = message.seq;
  out["sensor_time_ns"] = message.sensor_time_ns;
  out["dt"] = message.dt;
  out["merged"] = message.merged;
  out["flags"] = message.flags;
  out["flag_words"] = words;
  out["status"] = message.status;
  out["delta_theta"] = message.delta_theta;
  return out;
}

constexpr std::array<std::pair<const char*, double status_t::*>, 7> kFigures{
    {{"input_rate_hz", &status_t::input_rate_hz},
     {"output_rate_hz", &status_t::output_rate_hz},
     {"clock_offset_ppm", &status_t::clock_offset_ppm},
     {"latency_p50_us", &status_t::latency_p50_us},
     {"latency_p99_us", &status_t::latency_p99_us},
     {"latency_max_us", &status_t::latency_max_us},
     {"allan_tau0_s", &status_t::allan_tau0_s}}};

}  // namespace

std::string message_json(std::string_view sensor, const rate_t& message) {
  ordered_json out = of_samples("rate", sensor, message);
  out["arrival_ns"] = message.arrival_ns;
  out["raw"] = message.raw;
  out["compensated"] = message.compensated;
  out["denoised"] = message.denoised;
  out["variance"] = message.variance;
  out["covered"] = message.covered;
  out["angle"] = message.angle;
  out["innovation"] = message.innovation;
  out["innovation_variance"] = message.innovation_variance;
  out["gain"] = message.gain;
  out["group_delay"] = message.group_delay;
  out["correlation_time"] = message.correlation_time;
  out["model"] = message.model;
  return json_text(out, -1);
}

std::string message_json(std::string_view sensor, const status_t& message) {
  ordered_json out = of("status", sensor);
  out["utime"] = message.utime;
  out["version"] = message.version;
  out["model"] = message.model;
  out["state"] = message.state;
  out["state_name"] = state_name(message.state);
  out["fault"] = message.fault;
  for (const StatusCounter& each : kStatusCounters) out[each.name] = message.*each.count;
  for (const auto& [name, member] : kFigures) out[name] = message.*member;
  out["model_since"] = message.model_since;
  out["noticed"] = message.noticed;
  out["notice"] = message.notice;
  out["nis_mean"] = message.nis_mean;
  out["whiteness"] = message.whiteness;
  out["measurement_noise"] = message.measurement_noise;
  out["channel_name"] = message.channel_name;
  out["channel_value"] = message.channel_value;
  out["channel_age_s"] = message.channel_age_s;
  out["allan_rate_radps"] = message.allan_rate_radps;
  return json_text(out, -1);
}

std::string message_json(std::string_view sensor, const imu_t& message) {
  ordered_json out = of_samples("imu", sensor, message);
  out["turned_s"] = message.turned_s;
  out["delta_v"] = message.delta_v;
  out["moved_s"] = message.moved_s;
  out["temperature_degC"] = message.temperature_degC;
  return json_text(out, -1);
}

}  // namespace ifog::tools

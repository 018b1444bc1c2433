// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/monitor/message_json.h"

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "msgs/flag_names.h"
#include "msgs/state_name.h"

namespace ifog::tools {
namespace {

using nlohmann::ordered_json;

// Names may hold any bytes: what is no UTF-8 is replaced, not an error.
std::string line(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json of(const char* type, std::string_view sensor) {
  return {{"schema", "ifog.monitor/1"}, {"type", type}, {"sensor", sensor}};
}

ordered_json flag_words(std::int32_t flags) {
  ordered_json out = ordered_json::array();
  for (const FlagName& each : kFlagNames)
    if ((flags & each.flag) != 0) out.push_back(each.name);
  return out;
}

constexpr std::array<std::pair<const char*, std::int64_t status_t::*>, 47> kCounts{
    {{"samples_decoded", &status_t::samples_decoded},
     {"samples_in", &status_t::samples_in},
     {"samples_published", &status_t::samples_published},
     {"samples_waiting", &status_t::samples_waiting},
     {"bytes_read", &status_t::bytes_read},
     {"bytes_framed", &status_t::bytes_framed},
     {"bytes_pending", &status_t::bytes_pending},
     {"frames_read", &status_t::frames_read},
     {"frames_other", &status_t::frames_other},
     {"frames_good", &status_t::frames_good},
     {"frames_crc", &status_t::frames_crc},
     {"frames_format", &status_t::frames_format},
     {"log_faults", &status_t::log_faults},
     {"bytes_skipped", &status_t::bytes_skipped},
     {"frames_repeated", &status_t::frames_repeated},
     {"samples_repeated", &status_t::samples_repeated},
     {"samples_incomplete", &status_t::samples_incomplete},
     {"sequence_gaps", &status_t::sequence_gaps},
     {"sequence_missing", &status_t::sequence_missing},
     {"ring_overflows", &status_t::ring_overflows},
     {"samples_merged", &status_t::samples_merged},
     {"kernel_drops", &status_t::kernel_drops},
     {"stood_back", &status_t::stood_back},
     {"transport_warnings", &status_t::transport_warnings},
     {"can_error_frames", &status_t::can_error_frames},
     {"reopened", &status_t::reopened},
     {"lcm_failures", &status_t::lcm_failures},
     {"imu_failures", &status_t::imu_failures},
     {"invalid_samples", &status_t::invalid_samples},
     {"saturated_samples", &status_t::saturated_samples},
     {"implausible_samples", &status_t::implausible_samples},
     {"channel_drops", &status_t::channel_drops},
     {"channel_implausible", &status_t::channel_implausible},
     {"gated", &status_t::gated},
     {"channel_stale", &status_t::channel_stale},
     {"out_of_range", &status_t::out_of_range},
     {"corrections_refused", &status_t::corrections_refused},
     {"events_lost", &status_t::events_lost},
     {"record_deliveries", &status_t::record_deliveries},
     {"record_lost", &status_t::record_lost},
     {"record_lost_bytes", &status_t::record_lost_bytes},
     {"record_file_bytes", &status_t::record_file_bytes},
     {"record_removed", &status_t::record_removed},
     {"floor_hits", &status_t::floor_hits},
     {"manoeuvres", &status_t::manoeuvres},
     {"divergences", &status_t::divergences},
     {"filter_resets", &status_t::filter_resets}}};

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
  ordered_json out = of("rate", sensor);
  out["utime"] = message.utime;
  out["seq"] = message.seq;
  out["sensor_time_ns"] = message.sensor_time_ns;
  out["arrival_ns"] = message.arrival_ns;
  out["dt"] = message.dt;
  out["merged"] = message.merged;
  out["flags"] = message.flags;
  out["flag_words"] = flag_words(message.flags);
  out["status"] = message.status;
  out["raw"] = message.raw;
  out["compensated"] = message.compensated;
  out["denoised"] = message.denoised;
  out["variance"] = message.variance;
  out["delta_theta"] = message.delta_theta;
  out["covered"] = message.covered;
  out["angle"] = message.angle;
  out["innovation"] = message.innovation;
  out["innovation_variance"] = message.innovation_variance;
  out["gain"] = message.gain;
  out["group_delay"] = message.group_delay;
  out["correlation_time"] = message.correlation_time;
  out["model"] = message.model;
  return line(out);
}

std::string message_json(std::string_view sensor, const status_t& message) {
  ordered_json out = of("status", sensor);
  out["utime"] = message.utime;
  out["version"] = message.version;
  out["model"] = message.model;
  out["state"] = message.state;
  out["state_name"] = state_name(message.state);
  out["fault"] = message.fault;
  for (const auto& [name, member] : kCounts) out[name] = message.*member;
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
  return line(out);
}

std::string message_json(std::string_view sensor, const imu_t& message) {
  ordered_json out = of("imu", sensor);
  out["utime"] = message.utime;
  out["seq"] = message.seq;
  out["sensor_time_ns"] = message.sensor_time_ns;
  out["dt"] = message.dt;
  out["merged"] = message.merged;
  out["flags"] = message.flags;
  out["flag_words"] = flag_words(message.flags);
  out["status"] = message.status;
  out["delta_theta"] = message.delta_theta;
  out["turned_s"] = message.turned_s;
  out["delta_v"] = message.delta_v;
  out["moved_s"] = message.moved_s;
  out["temperature_degC"] = message.temperature_degC;
  return line(out);
}

}  // namespace ifog::tools

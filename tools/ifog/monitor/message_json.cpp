#include "tools/ifog/monitor/message_json.h"

#include <nlohmann/json.hpp>

#include "msgs/flag_names.h"
#include "msgs/state_name.h"

namespace ifog::tools {
namespace {

using nlohmann::ordered_json;

// Names may hold any bytes: what is no UTF-8 is replaced, not an error.
std::string line(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json flag_words(std::int32_t flags) {
  ordered_json out = ordered_json::array();
  for (const FlagName& each : kFlagNames)
    if ((flags & each.flag) != 0) out.push_back(each.name);
  return out;
}

}  // namespace

std::string message_json(std::string_view sensor, const rate_t& message) {
  ordered_json out{{"type", "rate"}, {"sensor", sensor}};
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
  ordered_json out{{"type", "status"}, {"sensor", sensor}};
  out["utime"] = message.utime;
  out["version"] = message.version;
  out["model"] = message.model;
  out["state"] = message.state;
  out["state_name"] = state_name(message.state);
  out["fault"] = message.fault;
  out["samples_decoded"] = message.samples_decoded;
  out["samples_in"] = message.samples_in;
  out["samples_published"] = message.samples_published;
  out["samples_waiting"] = message.samples_waiting;
  out["bytes_read"] = message.bytes_read;
  out["bytes_framed"] = message.bytes_framed;
  out["bytes_pending"] = message.bytes_pending;
  out["frames_read"] = message.frames_read;
  out["frames_other"] = message.frames_other;
  out["frames_good"] = message.frames_good;
  out["frames_crc"] = message.frames_crc;
  out["frames_format"] = message.frames_format;
  out["log_faults"] = message.log_faults;
  out["bytes_skipped"] = message.bytes_skipped;
  out["frames_repeated"] = message.frames_repeated;
  out["samples_repeated"] = message.samples_repeated;
  out["samples_incomplete"] = message.samples_incomplete;
  out["sequence_gaps"] = message.sequence_gaps;
  out["sequence_missing"] = message.sequence_missing;
  out["ring_overflows"] = message.ring_overflows;
  out["samples_merged"] = message.samples_merged;
  out["kernel_drops"] = message.kernel_drops;
  out["stood_back"] = message.stood_back;
  out["transport_warnings"] = message.transport_warnings;
  out["can_error_frames"] = message.can_error_frames;
  out["reopened"] = message.reopened;
  out["lcm_failures"] = message.lcm_failures;
  out["imu_failures"] = message.imu_failures;
  out["invalid_samples"] = message.invalid_samples;
  out["saturated_samples"] = message.saturated_samples;
  out["implausible_samples"] = message.implausible_samples;
  out["channel_drops"] = message.channel_drops;
  out["channel_implausible"] = message.channel_implausible;
  out["gated"] = message.gated;
  out["channel_stale"] = message.channel_stale;
  out["out_of_range"] = message.out_of_range;
  out["corrections_refused"] = message.corrections_refused;
  out["events_lost"] = message.events_lost;
  out["record_deliveries"] = message.record_deliveries;
  out["record_lost"] = message.record_lost;
  out["record_lost_bytes"] = message.record_lost_bytes;
  out["record_file_bytes"] = message.record_file_bytes;
  out["record_removed"] = message.record_removed;
  out["input_rate_hz"] = message.input_rate_hz;
  out["output_rate_hz"] = message.output_rate_hz;
  out["clock_offset_ppm"] = message.clock_offset_ppm;
  out["latency_p50_us"] = message.latency_p50_us;
  out["latency_p99_us"] = message.latency_p99_us;
  out["latency_max_us"] = message.latency_max_us;
  out["nis_mean"] = message.nis_mean;
  out["whiteness"] = message.whiteness;
  out["measurement_noise"] = message.measurement_noise;
  out["floor_hits"] = message.floor_hits;
  out["manoeuvres"] = message.manoeuvres;
  out["divergences"] = message.divergences;
  out["filter_resets"] = message.filter_resets;
  out["channel_name"] = message.channel_name;
  out["channel_value"] = message.channel_value;
  out["channel_age_s"] = message.channel_age_s;
  out["allan_tau0_s"] = message.allan_tau0_s;
  out["allan_rate_radps"] = message.allan_rate_radps;
  return line(out);
}

std::string message_json(std::string_view sensor, const imu_t& message) {
  ordered_json out{{"type", "imu"}, {"sensor", sensor}};
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

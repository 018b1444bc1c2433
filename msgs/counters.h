// SPDX-License-Identifier: Apache-2.0
// List of the counters in status_t for the daemon's log, `ifog monitor`, `ifog status` and the JSON. A new
// counter needs a line here, one in status_t.lcm, one in its schema, and the code that counts.
#pragma once

#include <array>
#include <cstdint>
#include <ifog/status_t.hpp>

namespace ifog {

enum StatusCounterUse : std::uint8_t {
  kCounterOnly = 0,
  kCounterLogged = 1,  // constant without faults: the log reports its increase
  kCounterListed = 2   // `ifog status` lists it among the losses
};

struct StatusCounter {
  const char* name;
  std::int64_t status_t::*count;
  unsigned use = kCounterOnly;
  const char* loss = "";  // what the monitor calls it among the losses; "": it is none
};

// In the message's order. The recorder reports its losses itself, and stale channels are logged by name.
inline constexpr std::array kStatusCounters{
    StatusCounter{"samples_decoded", &status_t::samples_decoded},
    StatusCounter{"samples_in", &status_t::samples_in},
    StatusCounter{"samples_published", &status_t::samples_published},
    StatusCounter{"samples_waiting", &status_t::samples_waiting},
    StatusCounter{"bytes_read", &status_t::bytes_read},
    StatusCounter{"bytes_framed", &status_t::bytes_framed},
    StatusCounter{"bytes_pending", &status_t::bytes_pending},
    StatusCounter{"frames_read", &status_t::frames_read},
    StatusCounter{"frames_other", &status_t::frames_other},
    StatusCounter{"frames_good", &status_t::frames_good},
    StatusCounter{"frames_crc", &status_t::frames_crc, kCounterLogged | kCounterListed,
                  "frames with a wrong checksum"},
    StatusCounter{"frames_format", &status_t::frames_format, kCounterLogged | kCounterListed,
                  "frames refused"},
    StatusCounter{"log_faults", &status_t::log_faults, kCounterLogged | kCounterListed, "log faults"},
    StatusCounter{"bytes_skipped", &status_t::bytes_skipped, kCounterLogged | kCounterListed,
                  "bytes skipped"},
    StatusCounter{"frames_repeated", &status_t::frames_repeated, kCounterLogged, "frames repeated"},
    StatusCounter{"samples_repeated", &status_t::samples_repeated, kCounterLogged, "samples repeated"},
    StatusCounter{"samples_incomplete", &status_t::samples_incomplete, kCounterLogged | kCounterListed,
                  "samples incomplete"},
    StatusCounter{"sequence_gaps", &status_t::sequence_gaps, kCounterLogged},
    StatusCounter{"sequence_missing", &status_t::sequence_missing, kCounterLogged | kCounterListed,
                  "missing by the device's counter or clock"},
    StatusCounter{"ring_overflows", &status_t::ring_overflows, kCounterLogged},
    StatusCounter{"samples_merged", &status_t::samples_merged, kCounterLogged, "merged"},
    StatusCounter{"kernel_drops", &status_t::kernel_drops, kCounterLogged | kCounterListed, "kernel drops"},
    StatusCounter{"stood_back", &status_t::stood_back, kCounterLogged},
    StatusCounter{"transport_warnings", &status_t::transport_warnings, kCounterLogged},
    StatusCounter{"can_error_frames", &status_t::can_error_frames, kCounterLogged | kCounterListed,
                  "line errors"},
    StatusCounter{"reopened", &status_t::reopened, kCounterLogged, "device reopened"},
    StatusCounter{"lcm_failures", &status_t::lcm_failures, kCounterLogged | kCounterListed, "not sent"},
    StatusCounter{"imu_failures", &status_t::imu_failures, kCounterLogged | kCounterListed,
                  "increments not sent"},
    StatusCounter{"invalid_samples", &status_t::invalid_samples, kCounterLogged | kCounterListed, "invalid"},
    StatusCounter{"saturated_samples", &status_t::saturated_samples, kCounterLogged},
    StatusCounter{"implausible_samples", &status_t::implausible_samples, kCounterLogged},
    StatusCounter{"channel_drops", &status_t::channel_drops, kCounterLogged | kCounterListed,
                  "channel messages dropped"},
    StatusCounter{"channel_implausible", &status_t::channel_implausible, kCounterLogged | kCounterListed,
                  "channel values refused"},
    StatusCounter{"gated", &status_t::gated},
    StatusCounter{"channel_stale", &status_t::channel_stale, kCounterOnly, "samples with a stale channel"},
    StatusCounter{"out_of_range", &status_t::out_of_range, kCounterLogged},
    StatusCounter{"corrections_refused", &status_t::corrections_refused, kCounterLogged | kCounterListed,
                  "corrections refused"},
    StatusCounter{"events_lost", &status_t::events_lost, kCounterLogged | kCounterListed,
                  "log lines dropped"},
    StatusCounter{"record_deliveries", &status_t::record_deliveries},
    StatusCounter{"record_lost", &status_t::record_lost, kCounterListed, "not recorded"},
    StatusCounter{"record_lost_bytes", &status_t::record_lost_bytes},
    StatusCounter{"record_file_bytes", &status_t::record_file_bytes},
    StatusCounter{"record_removed", &status_t::record_removed},
    StatusCounter{"floor_hits", &status_t::floor_hits},
    StatusCounter{"manoeuvres", &status_t::manoeuvres},
    StatusCounter{"divergences", &status_t::divergences, kCounterLogged},
    StatusCounter{"filter_resets", &status_t::filter_resets}};

}  // namespace ifog

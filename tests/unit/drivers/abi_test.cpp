// SPDX-License-Identifier: Apache-2.0
// The plugin interface as plugins built elsewhere know it: where every field lies. A change here breaks them,
// so IFOG_DRIVER_ABI must grow with it, and this table with that.
#include "drivers/ifog/driver.h"
#include "tests/unit/test.h"

namespace {

struct Place {
  const char* name;
  std::size_t is, was;  // offset of a field or size of a type, here and in version six
};

#define FIELD(type, field, was) \
  { #type "." #field, offsetof(type, field), was }

constexpr Place kVersionSix[] = {
    {"ifog_sample", sizeof(ifog_sample), 200},
    FIELD(ifog_sample, arrival_ns, 0),
    FIELD(ifog_sample, device_time_ns, 8),
    FIELD(ifog_sample, device_wrap_ns, 16),
    FIELD(ifog_sample, at_once, 68),
    FIELD(ifog_sample, sequence, 24),
    FIELD(ifog_sample, status, 28),
    FIELD(ifog_sample, flags, 32),
    FIELD(ifog_sample, valid_axes, 36),
    FIELD(ifog_sample, value, 40),
    FIELD(ifog_sample, environment_fresh, 64),
    FIELD(ifog_sample, environment, 72),
    {"ifog_can_frame", sizeof(ifog_can_frame), 80},
    FIELD(ifog_can_frame, arrival_ns, 0),
    FIELD(ifog_can_frame, id, 8),
    FIELD(ifog_can_frame, flags, 12),
    FIELD(ifog_can_frame, length, 13),
    FIELD(ifog_can_frame, data, 14),
    {"ifog_driver_counters", sizeof(ifog_driver_counters), 160},
    FIELD(ifog_driver_counters, frames_good, 0),
    FIELD(ifog_driver_counters, frames_crc, 8),
    FIELD(ifog_driver_counters, frames_format, 16),
    FIELD(ifog_driver_counters, bytes_skipped, 24),
    FIELD(ifog_driver_counters, frames_repeated, 32),
    FIELD(ifog_driver_counters, samples_incomplete, 40),
    FIELD(ifog_driver_counters, bytes_framed, 48),
    FIELD(ifog_driver_counters, bytes_pending, 56),
    FIELD(ifog_driver_counters, values_refused, 64),
    FIELD(ifog_driver_counters, frames_other, 72),
    FIELD(ifog_driver_counters, values_beyond, 80),
    FIELD(ifog_driver_counters, beyond_name, 88),
    FIELD(ifog_driver_counters, beyond_value, 136),
    FIELD(ifog_driver_counters, beyond_minimum, 144),
    FIELD(ifog_driver_counters, beyond_maximum, 152),
    {"ifog_description", sizeof(ifog_description), 1304},
    FIELD(ifog_description, kind, 0),
    FIELD(ifog_description, axes, 4),
    FIELD(ifog_description, axis, 8),
    FIELD(ifog_description, sequence_modulus, 152),
    FIELD(ifog_description, has_device_time, 156),
    FIELD(ifog_description, nominal_rate_hz, 160),
    FIELD(ifog_description, angle_wrap_rad, 168),
    FIELD(ifog_description, full_scale, 176),
    FIELD(ifog_description, environments, 200),
    FIELD(ifog_description, environment, 204),
    FIELD(ifog_description, can_ids, 972),
    FIELD(ifog_description, can_id, 976),
    FIELD(ifog_description, baud, 1232),
    FIELD(ifog_description, opening, 1236),
    FIELD(ifog_description, opening_length, 1300),
    {"ifog_setting", sizeof(ifog_setting), 16},
    {"ifog_option", sizeof(ifog_option), 32},
    FIELD(ifog_option, key, 0),
    FIELD(ifog_option, values, 8),
    FIELD(ifog_option, default_value, 16),
    FIELD(ifog_option, help, 24),
    {"ifog_driver", sizeof(ifog_driver), 112},
    FIELD(ifog_driver, abi, 0),
    FIELD(ifog_driver, transports, 4),
    FIELD(ifog_driver, name, 8),
    FIELD(ifog_driver, version, 16),
    FIELD(ifog_driver, summary, 24),
    FIELD(ifog_driver, options, 32),
    FIELD(ifog_driver, create, 40),
    FIELD(ifog_driver, destroy, 48),
    FIELD(ifog_driver, describe, 56),
    FIELD(ifog_driver, decode_bytes, 64),
    FIELD(ifog_driver, decode_can, 72),
    FIELD(ifog_driver, reset, 80),
    FIELD(ifog_driver, counters, 88),
    FIELD(ifog_driver, encode_bytes, 96),
    FIELD(ifog_driver, encode_can, 104),
};

#undef FIELD

// Sizes on a machine with pointers of eight bytes, x86-64 and AArch64 alike.
TEST(DriverAbi, VersionSixIsWhatItWas) {
  static_assert(sizeof(void*) == 8);
  ASSERT_EQ(IFOG_DRIVER_ABI, 6U) << "another version: write its layout here";
  for (const Place& place : kVersionSix)
    EXPECT_EQ(place.is, place.was) << place.name << ": the layout has changed, IFOG_DRIVER_ABI must grow";
}

}  // namespace

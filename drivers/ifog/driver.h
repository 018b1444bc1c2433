// SPDX-License-Identifier: Apache-2.0
/* The plugin interface of ifogd, in C so that a plugin may be built with any compiler and language.
 *
 * A protocol plugin is a pure function from (bytes, arrival time) to samples: it opens nothing, waits for
 * nothing, reads no clock. So the same bytes replay offline, go through a fuzzer, and come from the wire.
 *
 * Rules
 *   - The shared object exports one symbol, `ifog_driver_entry`, returning a table that lives as long as the
 *     object is loaded. The host checks `abi` before it reads anything else.
 *   - One instance serves one sensor and is called by one thread at a time.
 *   - After `create` has returned, `decode` must not allocate, lock, log or throw: it runs in the hot path.
 *   - SI units: rad, rad/s, m/s², s. Environment channels are in the unit their name ends in.
 *   - Missing values are NaN. A plugin need not check values: the host marks as invalid what is not finite or
 *     reaches `full_scale`.
 *
 * Version rule: IFOG_DRIVER_ABI grows whenever the meaning or layout of anything here changes. A host loads
 * exactly its own number, and says both numbers when it refuses.
 */
#ifndef IFOG_DRIVER_H
#define IFOG_DRIVER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define IFOG_DRIVER_ABI 6u
#define IFOG_MAX_AXES 3
#define IFOG_MAX_ENVIRONMENT 16
#define IFOG_NAME_LENGTH 48
#define IFOG_MAX_CAN_IDS 32

/* No device measures more: the host marks larger values as invalid. Rates in rad/s (a spinning projectile
 * turns at 2e3), environment values in their own units. */
#define IFOG_MAX_RATE 1e4
#define IFOG_MAX_ENVIRONMENT_VALUE 1e20

/* What the sensor measures. Decides how a sample becomes an angle increment. */
enum ifog_kind {
  IFOG_RATE = 0,        /* rad/s, the mean rate since the sample before */
  IFOG_DELTA_ANGLE = 1, /* rad, turned since the sample before */
  IFOG_ANGLE = 2        /* rad, turned since power-up; wraps at `angle_wrap_rad` where that is not 0 */
};

/* Bits: what the plugin decodes. */
enum ifog_transport { IFOG_TRANSPORT_BYTES = 1, IFOG_TRANSPORT_CAN = 2 };

enum ifog_sample_flags {
  IFOG_SAMPLE_DEVICE_TIME = 1, /* device_time_ns is set */
  IFOG_SAMPLE_SEQUENCE = 2,    /* sequence is set */
  IFOG_SAMPLE_BEYOND = 4       /* a value is beyond the range that the format states; it is kept */
};

/* One reading of the sensor. */
typedef struct ifog_sample {
  int64_t arrival_ns;     /* of the read that delivered its last byte, ns; 0: unknown */
  int64_t device_time_ns; /* the device's own clock as sent, any origin; the host unwraps rollovers */
  int64_t device_wrap_ns; /* the device's clock rolls over after this, ns; 0: never */
  uint32_t sequence;      /* the device's counter as sent, 0 … sequence_modulus − 1 */
  uint32_t status;        /* the device's status word as sent */
  uint32_t flags;         /* ifog_sample_flags */
  uint32_t valid_axes;    /* bit i: value[i] may be used (the device says so and it is finite) */
  double value[IFOG_MAX_AXES];
  uint32_t environment_fresh; /* bit i: environment[i] was received with this sample */
  uint32_t at_once;           /* Set by the host: samples in the same read; 0: unknown. Plugins leave it 0. */
  double environment[IFOG_MAX_ENVIRONMENT]; /* last known values, NaN until the first */
} ifog_sample;

enum ifog_can_flags { IFOG_CAN_EXTENDED = 1, IFOG_CAN_FD = 2, IFOG_CAN_BRS = 4 };

/* A data frame; error and remote frames never reach a plugin. */
typedef struct ifog_can_frame {
  int64_t arrival_ns; /* time of reception, ns on an unslewed monotonic clock; 0: unknown */
  uint32_t id;        /* 11 or 29 bits, without flag bits */
  uint8_t flags;      /* ifog_can_flags */
  uint8_t length;     /* bytes, 0 … 64 */
  uint8_t data[64];
} ifog_can_frame;

/* Counters only grow. The host reads them once a second from the reader thread. */
typedef struct ifog_driver_counters {
  uint64_t frames_good;     /* complete frames that passed every check */
  uint64_t frames_crc;      /* frame header found, checksum wrong */
  uint64_t frames_format;   /* frame understood but a field impossible (bad number, short CAN frame, …) */
  uint64_t bytes_skipped;   /* bytes dropped while searching for the next frame */
  uint64_t frames_repeated; /* good frames received a second time and dropped */
  uint64_t samples_incomplete; /* samples dropped because some of their frames are missing */
  uint64_t bytes_framed;       /* bytes of complete frames, good or bad; of a text protocol, of its lines */
  /* Not monotonic: bytes buffered as a possible frame start; 0 for CAN. Every byte that was fed is in
   * bytes_framed, bytes_skipped or bytes_pending; the host checks this identity. */
  uint64_t bytes_pending;
  uint64_t values_refused; /* environment values dropped as impossible; the last good one is held */
  uint64_t frames_other;   /* CAN frames that are none of the sensor's. Every CAN frame that was fed is in
                              frames_good, frames_format or frames_other; the host checks it */
  /* Values beyond the range that a description of the format states: such ranges are information, often
   * wrong, and the values are kept. The first of them, in the format's unit, with its name and that range. */
  uint64_t values_beyond;
  char beyond_name[IFOG_NAME_LENGTH];
  double beyond_value, beyond_minimum, beyond_maximum;
} ifog_driver_counters;

/* What a configured instance will deliver. Filled by `describe`, constant afterwards. */
typedef struct ifog_description {
  uint32_t kind;                              /* ifog_kind */
  uint32_t axes;                              /* 1 … IFOG_MAX_AXES */
  char axis[IFOG_MAX_AXES][IFOG_NAME_LENGTH]; /* "x", "y", "z"; "" for a single-axis sensor */
  uint32_t sequence_modulus;        /* the counter counts modulo this; 0: the device sends no counter */
  uint32_t has_device_time;         /* 1: samples carry device_time_ns */
  double nominal_rate_hz;           /* samples a second; 0: unknown, the configuration must say */
  double angle_wrap_rad;            /* IFOG_ANGLE: the value wraps modulo this; 0: it does not */
  double full_scale[IFOG_MAX_AXES]; /* largest measurable rate of each axis, rad/s; 0: unknown */
  uint32_t environments;            /* 0 … IFOG_MAX_ENVIRONMENT */
  char environment[IFOG_MAX_ENVIRONMENT][IFOG_NAME_LENGTH]; /* capture column names: "temperature_degC" */
  uint32_t can_ids; /* wanted CAN ids, for the kernel's filter; 0: all */
  struct {
    uint32_t id;
    uint32_t extended;
  } can_id[IFOG_MAX_CAN_IDS];
  uint32_t baud;       /* serial speed the maker specifies; 0: the configuration must say */
  uint8_t opening[64]; /* bytes to send when the device opens */
  uint32_t opening_length;
} ifog_description;

/* One `key = value` of the sensor's [sensor.options] table, value as text. Owned by the host, invalid after
 * `create` returns. The host has refused unknown keys and passes every option of the list, the default where the user
 * gave none. */
typedef struct ifog_setting {
  const char* key;
  const char* value;
} ifog_setting;

/* An option the plugin knows; the list is what `ifog drivers` prints and what unknown keys are checked
 * against. */
#define IFOG_OPTION_FILE "a file" /* `values` of a path, relative to the configuration file */
typedef struct ifog_option {
  const char* key;
  const char* values;        /* what is allowed, for people: "rate | delta" or "a number > 0" */
  const char* default_value; /* NULL: must be given */
  const char* help;          /* one line */
} ifog_option;

typedef void (*ifog_emit_sample)(void* sink, const ifog_sample* sample);
typedef void (*ifog_emit_bytes)(void* sink, const uint8_t* bytes, size_t length);
typedef void (*ifog_emit_can)(void* sink, const ifog_can_frame* frame);

typedef struct ifog_driver {
  uint32_t abi;        /* IFOG_DRIVER_ABI */
  uint32_t transports; /* ifog_transport bits */
  const char* name;    /* as in `driver = "…"`: lower case, digits, dash */
  const char* version;
  const char* summary;        /* one line */
  const ifog_option* options; /* ended by an entry whose key is NULL */

  /* Makes an instance, or returns NULL with one line in error: the key, its value and what was expected. With
   * an instance, `error` may hold warnings, one a line, which the host logs; else it is "". */
  void* (*create)(const ifog_setting* settings, size_t count, char* error, size_t error_size);
  void (*destroy)(void* instance);
  void (*describe)(const void* instance, ifog_description* out);

  /* Bytes in order, split anywhere. arrival_ns: of the last byte of this read. NULL if CAN only. */
  void (*decode_bytes)(void* instance, const uint8_t* bytes, size_t length, int64_t arrival_ns,
                       ifog_emit_sample emit, void* sink);
  /* One CAN frame. NULL if bytes only. */
  void (*decode_can)(void* instance, const ifog_can_frame* frame, ifog_emit_sample emit, void* sink);
  /* Drops partial frames: the device was reopened, or its recording has ended. Counters are kept and count
   * what is dropped: bytes as skipped, a partial sample as incomplete. */
  void (*reset)(void* instance);
  void (*counters)(const void* instance, ifog_driver_counters* out);

  /* The inverse, for `ifog convert` and `ifog replay`; NULL if the plugin has none. Returns 0, or −1 with
   * one line in error when the sample cannot be expressed in the format (out of range, an axis missing). */
  int (*encode_bytes)(void* instance, const ifog_sample* sample, ifog_emit_bytes emit, void* sink,
                      char* error, size_t error_size);
  int (*encode_can)(void* instance, const ifog_sample* sample, ifog_emit_can emit, void* sink, char* error,
                    size_t error_size);
} ifog_driver;

#if defined(__GNUC__)
#define IFOG_EXPORT __attribute__((visibility("default")))
#else
#define IFOG_EXPORT
#endif

/* The one exported symbol. */
IFOG_EXPORT const ifog_driver* ifog_driver_entry(void);

#ifdef __cplusplus
}
#endif
#endif

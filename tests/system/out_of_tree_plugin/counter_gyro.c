// SPDX-License-Identifier: Apache-2.0
/* A gyro that sends one byte a sample: its rate as signed whole degrees per second. Written in C and against the
 * installed headers only, as the interface promises is possible. */
#include <ifog/driver.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef ABI
#define ABI IFOG_DRIVER_ABI
#endif

struct gyro {
  ifog_driver_counters counters;
  uint32_t sequence;
  double rate_hz;
};

static const ifog_option options[] = {{"rate_hz", "a number > 0", NULL, "data rate"}, {NULL, NULL, NULL, NULL}};

static void* create(const ifog_setting* settings, size_t count, char* error, size_t error_size) {
  for (size_t i = 0; i < count; ++i) {
    char* end = NULL;
    const double rate = strtod(settings[i].value, &end);
    if (strcmp(settings[i].key, "rate_hz") != 0 || *end != '\0' || !(rate > 0.0)) {
      snprintf(error, error_size, "%s is '%s', expected a number > 0", settings[i].key, settings[i].value);
      return NULL;
    }
    struct gyro* gyro = calloc(1, sizeof *gyro);
    if (gyro != NULL) gyro->rate_hz = rate;
    return gyro;
  }
  return NULL;
}

static void describe(const void* instance, ifog_description* out) {
  memset(out, 0, sizeof *out);
  out->kind = IFOG_RATE;
  out->axes = 1;
  out->sequence_modulus = 65536;
  out->nominal_rate_hz = ((const struct gyro*)instance)->rate_hz;
}

static void decode(void* instance, const uint8_t* bytes, size_t length, int64_t arrival_ns, ifog_emit_sample emit,
                   void* sink) {
  struct gyro* gyro = instance;
  for (size_t i = 0; i < length; ++i) {
    ifog_sample sample;
    memset(&sample, 0, sizeof sample);
    sample.arrival_ns = arrival_ns;
    sample.flags = IFOG_SAMPLE_SEQUENCE;
    sample.sequence = gyro->sequence++ % 65536;
    sample.value[0] = (double)(int8_t)bytes[i] * 3.14159265358979323846 / 180.0;
    sample.valid_axes = 1;
    ++gyro->counters.frames_good;
    ++gyro->counters.bytes_framed;
    emit(sink, &sample);
  }
}

static void reset(void* instance) { (void)instance; }

static void counters(const void* instance, ifog_driver_counters* out) { *out = ((const struct gyro*)instance)->counters; }

static const ifog_driver table = {
    .abi = ABI,
    .transports = IFOG_TRANSPORT_BYTES,
    .name = "counter_gyro",
    .version = "1",
    .summary = "a third party's driver in C",
    .options = options,
    .create = create,
    .destroy = free,
    .describe = describe,
    .decode_bytes = decode,
    .reset = reset,
    .counters = counters,
};

const ifog_driver* ifog_driver_entry(void) { return &table; }

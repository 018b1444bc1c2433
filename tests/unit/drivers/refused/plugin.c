// SPDX-License-Identifier: Apache-2.0
/* Plugins that the host must refuse, one by a macro each; and one in C++ that throws. */
#include <ifog/driver.h>
#include <stddef.h>
#include <string.h>

#ifdef OPTION_UNSAID
static const ifog_option options[] = {{"format", NULL, "a", "no word of what is allowed"}, {NULL, NULL, NULL, NULL}};
#else
static const ifog_option options[] = {{NULL, NULL, NULL, NULL}};
#endif
#ifndef WITHOUT_CREATE
static void* create(const ifog_setting* settings, size_t count, char* error, size_t error_size) {
  (void)settings, (void)count, (void)error, (void)error_size;
  static int instance;
  return &instance;
}
#endif
static void destroy(void* instance) { (void)instance; }
static void describe(const void* instance, ifog_description* out) {
  (void)instance;
  out->axes = AXES;
#ifdef CHANNEL
  out->environments = 1;
  strcpy(out->environment[0], CHANNEL);
#endif
}
static void decode(void* instance, const uint8_t* bytes, size_t length, int64_t arrival_ns, ifog_emit_sample emit,
                   void* sink) {
  (void)instance, (void)bytes, (void)length, (void)arrival_ns, (void)emit, (void)sink;
#ifdef THROWN
  throw std::runtime_error(THROWN);
#endif
}
static void reset(void* instance) { (void)instance; }
static void counters(const void* instance, ifog_driver_counters* out) { (void)instance, (void)out; }

static const ifog_driver table = {
    .abi = ABI,
    .transports = IFOG_TRANSPORT_BYTES,
    .name = NAME,
    .version = "1",
    .summary = "refused",
    .options = options,
#ifndef WITHOUT_CREATE
    .create = create,
#endif
    .destroy = destroy,
    .describe = describe,
    .decode_bytes = decode,
    .reset = reset,
    .counters = counters,
};

#ifdef WITHOUT_ENTRY
const ifog_driver* another_name(void);
IFOG_EXPORT const ifog_driver* another_name(void) { return &table; }
#else
const ifog_driver* ifog_driver_entry(void) { return &table; }
#endif

// SPDX-License-Identifier: Apache-2.0
// Makes the C table of a plugin for a byte stream from a C++ class. Header only.
//
// The class has
//   explicit Driver(const ifog::plugin::Options&);        throws std::exception with the user's error message
//   void describe(ifog_description&) const;
//   void decode(std::span<const std::uint8_t>, std::int64_t arrival_ns, ifog_emit_sample, void* sink); no throw
//   void reset();
//   void counters(ifog_driver_counters&) const;
// and optionally, to make the device's bytes,
//   void encode(const ifog_sample&, ifog_emit_bytes, void* sink);   throws std::exception with the reason
#pragma once

#include <cstdint>
#include <cstdio>
#include <exception>
#include <span>

#include "driver.h"
#include "options.h"

namespace ifog::plugin {

template <typename Driver>
constexpr ifog_driver byte_driver(const char* name, const char* version, const char* summary,
                                  const ifog_option* options) {
  ifog_driver table{};
  table.abi = IFOG_DRIVER_ABI;
  table.transports = IFOG_TRANSPORT_BYTES;
  table.name = name;
  table.version = version;
  table.summary = summary;
  table.options = options;
  table.create = [](const ifog_setting* settings, size_t count, char* error, size_t error_size) -> void* {
    return create_or_explain(settings, count, error, error_size,
                             [](const Options& given) { return new Driver(given); });
  };
  table.destroy = [](void* instance) { delete static_cast<Driver*>(instance); };
  table.describe = [](const void* instance, ifog_description* out) {
    static_cast<const Driver*>(instance)->describe(*out);
  };
  table.decode_bytes = [](void* instance, const uint8_t* bytes, size_t length, int64_t arrival_ns,
                          ifog_emit_sample emit, void* sink) {
    static_cast<Driver*>(instance)->decode({bytes, length}, arrival_ns, emit, sink);
  };
  table.reset = [](void* instance) { static_cast<Driver*>(instance)->reset(); };
  table.counters = [](const void* instance, ifog_driver_counters* out) {
    static_cast<const Driver*>(instance)->counters(*out);
  };
  if constexpr (requires(Driver & driver, const ifog_sample& sample, ifog_emit_bytes emit, void* sink) {
                  driver.encode(sample, emit, sink);
                }) {
    table.encode_bytes = [](void* instance, const ifog_sample* sample, ifog_emit_bytes emit, void* sink,
                            char* error, size_t error_size) -> int {
      try {
        static_cast<Driver*>(instance)->encode(*sample, emit, sink);
        return 0;
      } catch (const std::exception& problem) {
        std::snprintf(error, error_size, "%s", problem.what());
        return -1;
      }
    };
  }
  return table;
}

}  // namespace ifog::plugin

// SPDX-License-Identifier: Apache-2.0
// How large and how deep what is read from outside may be: one table for every parser. Each limit is some ten times what
// the largest file known needs, and so small that what is accepted and what is refused both take seconds. Who passes one
// reads it in one line.
#pragma once

#include <cstddef>

namespace ifog {

struct InputLimits {
  // TOML: configurations, models, manifests, scenarios.
  std::size_t toml_bytes = std::size_t{16} << 20U;  // a model with its covariance has 0.3 MB
  std::size_t toml_key_parts = 64;                  // of a dotted key: the parser calls itself for each
  std::size_t unknown_keys = 100;                   // of a table, each listed by name
  std::size_t sensors = 256;                        // of a configuration, two threads each
  std::size_t captures = 65'536;                    // of a manifest, all gyros together
  // JSON: histories, proposals, results of a fleet.
  std::size_t json_bytes = std::size_t{64} << 20U;    // a history of a year of nights has 1 MB
  std::size_t json_depth = 64;                        // ours have 8
  std::size_t dbc_bytes = std::size_t{64} << 20U;     // a whole vehicle has some megabytes
  std::size_t multiplexors = 64;                      // each chosen by the one before; a frame has 64 bytes
  std::size_t csv_columns = 4096;                     // a loaded vehicle bus has a thousand signals
  std::size_t csv_rates = 256;                        // of one file; each is compared with every other
  std::size_t hdf5_columns = 1000;                    // each keeps unpacked chunks in memory
  std::size_t block_bytes = std::size_t{4} << 20U;    // of a recording's block, unpacked
  std::size_t carried_bytes = std::size_t{3} << 20U;  // files in a header, so that it fits into a block
};
inline constexpr InputLimits kInputLimits;

}  // namespace ifog

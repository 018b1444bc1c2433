// SPDX-License-Identifier: Apache-2.0
// Limits of the size and depth of all inputs. Each is about ten times the largest known need, and small
// enough for processing within seconds. Exceeding one gives a one-line error.
#pragma once

#include <cstddef>

namespace ifog {

struct InputLimits {
  // TOML: configurations, models, manifests, scenarios.
  std::size_t toml_bytes = std::size_t{16} << 20U;  // a model with its covariance has 0.3 MB
  std::size_t toml_dots = 5000;                     // in a line: the parser of dotted keys is recursive
  std::size_t unknown_keys = 100;                   // per table, each listed by name
  std::size_t sensors = 256;                        // per configuration, two threads each
  std::size_t captures = 65'536;                    // per manifest, all gyros together
  // JSON: histories, proposals, results of a fleet.
  std::size_t json_bytes = std::size_t{64} << 20U;    // a history of a year of nights has 1 MB
  std::size_t json_depth = 64;                        // ours have 8
  std::size_t dbc_bytes = std::size_t{64} << 20U;     // a whole vehicle has some megabytes
  std::size_t multiplexors = 64;                      // nested; a frame has 64 bytes
  std::size_t csv_columns = 4096;                     // a large vehicle bus has a thousand signals
  std::size_t csv_rates = 256;                        // per file; each is compared with every other
  std::size_t hdf5_columns = 1000;                    // each keeps unpacked chunks in memory
  std::size_t block_bytes = std::size_t{4} << 20U;    // per block of a recording, unpacked
  std::size_t carried_bytes = std::size_t{3} << 20U;  // files in a header, which must fit into a block
};
inline constexpr InputLimits kInputLimits;

}  // namespace ifog

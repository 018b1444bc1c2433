// SPDX-License-Identifier: Apache-2.0
// The manifest of a fleet: which gyros of one type there are and where their captures lie.
//
//   type = "DSP-1760"
//   [[gyro]]
//   serial = "A017"                           names its folder of results
//   captures = ["A017/cold.csv.gz", "…"]      relative to the manifest, each file once in all of it
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ifog::tools {

struct FleetGyro {
  std::string serial;
  std::vector<std::string> captures;  // as they can be opened
};

struct Manifest {
  std::string type;
  std::vector<FleetGyro> gyros;
};

// Throws std::runtime_error with one line: file, line, key, value, what was expected. A serial is 1 to 64
// letters, digits, '.', '_' and '-', the first a letter, digit or '_', and stands once, whatever its case: it
// names a folder.
Manifest read_manifest(const std::string& path);
// The same of a text; path: of the file that it would stand in.
Manifest parse_manifest(std::string_view text, const std::string& path);

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
// The manifest of a fleet: the gyros of one type and their captures.
//
//   type = "DSP-1760"
//   [[gyro]]
//   serial = "A017"                           name of its results folder
//   captures = ["A017/cold.csv.gz", "…"]      relative to the manifest; each file only once
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ifog::tools {

struct FleetGyro {
  std::string serial;
  std::vector<std::string> captures;  // paths that can be opened
};

struct Manifest {
  std::string type;
  std::vector<FleetGyro> gyros;
};

// Throws std::runtime_error with one line: file, line, key, value, expected value. A serial has 1 to 64
// letters, digits, '.', '_' and '-', and begins with a letter, digit or '_'. It is unique regardless of case,
// because it names a folder.
Manifest read_manifest(const std::string& path);
// The same from a text; path: for messages.
Manifest parse_manifest(std::string_view text, const std::string& path);

}  // namespace ifog::tools

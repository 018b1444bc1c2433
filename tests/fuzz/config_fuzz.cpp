// SPDX-License-Identifier: Apache-2.0
// Any text as a daemon configuration: read, or rejected with lines that contain the file's name.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "daemon/config/config.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    (void)ifog::parse_config({reinterpret_cast<const char*>(data), size}, "config");
  } catch (const ifog::ConfigError& error) {
    if (!std::string(error.what()).starts_with("config")) std::abort();
  }
  return 0;
}

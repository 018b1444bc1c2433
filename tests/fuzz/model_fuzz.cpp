// SPDX-License-Identifier: Apache-2.0
// Any text as a model file: read, or rejected with one line.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "filters/model_file/model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    (void)ifog::parse_model({reinterpret_cast<const char*>(data), size}, "model");
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
  }
  return 0;
}

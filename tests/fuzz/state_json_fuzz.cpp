// SPDX-License-Identifier: Apache-2.0
// Any text as JSON of the state folder or of a fleet's results: rejected with one line, or a value that can be written.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "tools/ifog/console/json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using ifog::tools::parse_json;
  try {
    const nlohmann::json json = parse_json({reinterpret_cast<const char*>(data), size}, "f");
    if (json.is_discarded()) return 0;
    const std::string text = json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
    if (parse_json(text, "f").is_discarded()) std::abort();
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
  }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Any text as a DBC file: rejected with one line, or read with warnings of one printable line each. Then
// every signal that fits its message decodes and encodes any frame within its bytes.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/dbc/codec.h"
#include "drivers/dbc/database.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ifog::dbc;
  Database database;
  try {
    database = parse_database({reinterpret_cast<const char*>(data), size}, "f");
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
    return 0;
  }
  for (const std::string& warning : database.warnings)
    if (warning.size() > 4000 || std::any_of(warning.begin(), warning.end(), [](char c) {
          return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
        }))
      std::abort();
  for (const Message& message : database.messages)
    for (const Signal& signal : message.signals) {
      try {
        check_fits(database, message, signal);
      } catch (const std::runtime_error&) {
        continue;
      }
      // On the heap with the message's exact length, so that the sanitizer detects one byte too many.
      std::vector<std::uint8_t> frame(message.length, 0xA5);
      if (bytes_needed(signal) > frame.size()) std::abort();
      const std::uint64_t bits = raw_bits(signal, frame);
      set_raw_bits(signal, bits, frame);
      if (raw_bits(signal, frame) != bits) std::abort();
      (void)selected(message, signal, frame);
      try {
        (void)raw_of(signal, physical(signal, bits));
      } catch (const std::invalid_argument&) {
        continue;
      }
    }
  return 0;
}

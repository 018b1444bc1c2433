// SPDX-License-Identifier: Apache-2.0
// Any line: no crash, and a frame that is read is equal after writing and reading.
#include <cstdlib>
#include <cstring>

#include "drivers/capture/candump/candump.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ifog;
  CandumpEntry entry;
  if (parse_candump_line({reinterpret_cast<const char*>(data), size}, entry) != CandumpLine::frame) return 0;
  char line[kCandumpLineMax];
  const std::size_t length = format_candump_line(entry.frame, entry.interface, line);
  if (length > kCandumpLineMax || line[length - 1] != '\n') std::abort();
  CandumpEntry again;
  if (parse_candump_line({line, length - 1}, again) != CandumpLine::frame) std::abort();
  if (again.frame.id != entry.frame.id || again.frame.flags != entry.frame.flags ||
      again.frame.length != entry.frame.length ||
      std::memcmp(again.frame.data, entry.frame.data, sizeof entry.frame.data) != 0)
    std::abort();
  return 0;
}

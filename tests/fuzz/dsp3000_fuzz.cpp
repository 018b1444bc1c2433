// SPDX-License-Identifier: Apache-2.0
// Any bytes: no crash, every byte counted, and a value that is read is equal after writing and reading.
#include <cstdlib>

#include "drivers/plugins/dsp3000/line.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ifog::dsp3000;
  LineFinder finder;
  std::size_t read = 0;
  finder.feed({data, size}, [&](const Reading& reading) {
    ++read;
    char line[kLongestLine];
    const std::size_t length = format_line(reading, line);
    if (length > kLongestLine) std::abort();
    const auto again = parse_line({line, length - 2});
    if (!again || again->micro_degrees != reading.micro_degrees || again->valid != reading.valid)
      std::abort();
  });
  if (read != finder.counters().frames_good || finder.counters().bytes_skipped > size) std::abort();
  return 0;
}

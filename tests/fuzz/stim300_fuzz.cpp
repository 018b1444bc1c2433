// SPDX-License-Identifier: Apache-2.0
// Any bytes, the first selects the termination: every one counted, and datagrams that pack to the same bytes.
#include <array>

#include "drivers/plugins/stim300/datagram.h"
#include "tests/fuzz/every_byte_counted.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ifog::stim300;
  if (size == 0) return 0;
  using Finder = ifog::framing::FrameFinder<Protocol>;
  const Protocol protocol{(data[0] & 1) != 0};
  ifog::every_byte_counted(
      Finder(protocol), Finder(protocol), {data + 1, size - 1}, [](std::span<const std::uint8_t> frame) {
        std::array<std::uint8_t, kLongestDatagram> packed{};
        const std::size_t length = pack(unpack(*content_of(frame[0]), frame), packed);
        if (!std::equal(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(length), frame.begin()))
          std::abort();
      });
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Any bytes: every one counted, and frames that pack to the same bytes.
#include <array>

#include "drivers/plugins/kvh1750/frame.h"
#include "tests/fuzz/every_byte_counted.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ifog::kvh;
  using Finder = ifog::framing::FrameFinder<Protocol>;
  ifog::every_byte_counted(Finder(), Finder(), {data, size}, [](std::span<const std::uint8_t> frame) {
    std::array<std::uint8_t, kLongestFrame> packed{};
    const std::size_t length = pack(unpack(frame), packed);
    if (!std::equal(frame.begin(), frame.end(), packed.begin(),
                    packed.begin() + static_cast<std::ptrdiff_t>(length)))
      std::abort();
  });
  return 0;
}

// Any bytes: no crash, every byte accounted for, frames that pack to the bytes they came from, and the same
// frames however the stream is cut into portions.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "drivers/plugins/kvh1750/frame_finder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ifog::kvh;
  std::vector<std::vector<std::uint8_t>> frames;
  FrameFinder whole;
  std::size_t good_bytes = 0;
  whole.feed({data, size}, [&](const Frame& frame) {
    std::array<std::uint8_t, kLongestFrame> packed{};
    const std::size_t length = pack(frame, packed);
    frames.emplace_back(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(length));
    good_bytes += length;
    if (std::search(data, data + size, packed.begin(),
                    packed.begin() + static_cast<std::ptrdiff_t>(length)) == data + size)
      std::abort();
  });
  if (good_bytes + whole.counters().bytes_skipped + whole.waiting() != size) std::abort();

  FrameFinder portions;
  std::size_t found = 0;
  for (std::size_t at = 0; at < size;) {
    const std::size_t n = std::min<std::size_t>(1 + data[at] % 61, size - at);
    portions.feed({data + at, n}, [&](const Frame&) { ++found; });
    at += n;
  }
  if (found != frames.size() || portions.counters().bytes_skipped != whole.counters().bytes_skipped)
    std::abort();
  return 0;
}

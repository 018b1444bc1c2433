// SPDX-License-Identifier: Apache-2.0
// For fuzzers of frame finders: aborts if a byte is lost or counted twice, or if the frames depend on how the
// stream is divided into reads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <utility>
#include <vector>

namespace ifog {

// `check` gets each frame.
template <typename Finder, typename Check>
void every_byte_counted(Finder whole, Finder portions, std::span<const std::uint8_t> bytes, Check&& check) {
  std::vector<std::vector<std::uint8_t>> frames;
  std::size_t framed = 0;
  whole.feed(bytes, [&](std::span<const std::uint8_t> frame) {
    framed += frame.size();
    if (std::search(bytes.begin(), bytes.end(), frame.begin(), frame.end()) == bytes.end()) std::abort();
    frames.emplace_back(frame.begin(), frame.end());
    check(frame);
  });
  if (framed + whole.counters().bytes_skipped + whole.waiting() != bytes.size()) std::abort();
  std::size_t found = 0;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t n = std::min<std::size_t>(1 + bytes[at] % 61, bytes.size() - at);
    portions.feed(bytes.subspan(at, n), [&](std::span<const std::uint8_t> frame) {
      if (found >= frames.size() ||
          !std::equal(frame.begin(), frame.end(), frames[found].begin(), frames[found].end()))
        std::abort();
      ++found;
    });
    at += n;
  }
  if (found != frames.size() || portions.counters().bytes_skipped != whole.counters().bytes_skipped)
    std::abort();
}

}  // namespace ifog

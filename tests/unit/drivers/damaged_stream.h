// SPDX-License-Identifier: Apache-2.0
// A stream of frames of which some are damaged in every way a line can, and the proof that a finder of frames takes every
// intact one out of it, with its own last byte, however the stream is cut into portions.
#pragma once

#include "drivers/plugins/framing/frame_finder.h"
#include "tests/unit/test.h"

namespace ifog {

using Bytes = std::vector<std::uint8_t>;
using Random = std::mt19937;

class DamagedStream {
 public:
  DamagedStream(const std::vector<Bytes>& frames, std::uint32_t seed, int segments)
      : frames_(frames), random_(seed) {
    for (int i = 0; i < segments; ++i) segment();
    put(frame());
  }
  Bytes bytes;

 private:
  std::size_t below(std::size_t n) { return random_() % n; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(below(256)); }
  const Bytes& frame() { return frames_[below(frames_.size())]; }
  void put(const Bytes& more) { bytes.insert(bytes.end(), more.begin(), more.end()); }
  void cut(std::size_t most) {
    Bytes f = frame();
    f.resize(below(std::min(f.size(), most)));
    put(f);
  }
  // Among it the beginnings of frames.
  void noise() {
    for (std::size_t n = below(60); n > 0; --n) {
      if (below(10) == 0) cut(28);
      bytes.push_back(byte());
    }
  }
  void segment() {
    Bytes f = frame();
    const std::size_t kind = below(8), times = 1 + below(4);
    if (kind == 3) return cut(f.size());
    if (kind == 4) return noise();
    if (kind == 5) return cut(f.size()), put(f);  // a frame whose tail an intact one has written over
    for (std::size_t n = 0; n < times; ++n) {
      if (kind == 0) f[below(f.size())] ^= static_cast<std::uint8_t>(1 + below(255));
      if (kind == 1) f.insert(f.begin() + static_cast<std::ptrdiff_t>(1 + below(f.size() - 1)), byte());
      if (kind == 2) f.erase(f.begin() + static_cast<std::ptrdiff_t>(below(f.size())));
    }
    put(f);
  }

  const std::vector<Bytes>& frames_;
  Random random_;
};

// frames: intact ones, made by a test from what it knows of the protocol. Each must be one to the protocol, and none with
// a changed byte. What is intact in the stream is found by asking the protocol at every position; damage can by chance
// leave a frame whole.
template <typename Protocol>
void every_intact_frame_comes_out(const std::vector<Bytes>& frames, int seeds, const Protocol& protocol) {
  using Finder = framing::FrameFinder<Protocol>;
  struct Placed {
    std::size_t end;
    Bytes bytes;
    bool operator==(const Placed&) const = default;
  };
  const auto length = [&](std::span<const std::uint8_t> bytes) -> std::size_t {
    const framing::Announced announced = protocol.at(bytes);
    const bool whole = announced.is == framing::Announced::Is::frame && announced.length <= bytes.size();
    return whole && protocol.intact(bytes.first(announced.length)) ? announced.length : 0;
  };
  Random changes(1);
  for (Bytes frame : frames) {
    ASSERT_EQ(length(frame), frame.size());
    frame[changes() % frame.size()] ^= static_cast<std::uint8_t>(1 + changes() % 255);
    EXPECT_NE(length(frame), frame.size());
  }
  for (int seed = 1; seed <= seeds; ++seed) {
    const Bytes stream = DamagedStream(frames, static_cast<std::uint32_t>(seed), 60).bytes;
    std::vector<Placed> present;
    std::size_t framed = 0;
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t n = length(std::span(stream).subspan(at));
      if (n != 0) {
        const auto begin = stream.begin() + static_cast<std::ptrdiff_t>(at);
        present.push_back({at + n, {begin, begin + static_cast<std::ptrdiff_t>(n)}});
      }
      framed += n;
      at += n == 0 ? 1 : n;
    }
    Finder single(protocol);
    std::vector<Placed> found;
    for (std::size_t i = 0; i < stream.size(); ++i)
      single.feed({&stream[i], 1}, [&](std::span<const std::uint8_t> f) {
        found.push_back({i + 1, {f.begin(), f.end()}});
      });
    ASSERT_EQ(found.size(), present.size()) << "seed " << seed;
    for (std::size_t i = 0; i < found.size(); ++i)
      ASSERT_TRUE(found[i] == present[i]) << "seed " << seed << " frame " << i;
    EXPECT_EQ(single.counters().bytes_framed, framed);
    EXPECT_EQ(framed + single.counters().bytes_skipped + single.waiting(), stream.size()) << "seed " << seed;

    Finder portions(protocol);
    Random random(static_cast<std::uint32_t>(seed) + 1'000'000);
    std::size_t count = 0;
    for (std::size_t i = 0; i < stream.size();) {
      const std::size_t n =
          std::min<std::size_t>(1 + random() % (seed % 2 == 0 ? 50 : 9000), stream.size() - i);
      portions.feed({&stream[i], n}, [&](std::span<const std::uint8_t>) { ++count; });
      i += n;
    }
    EXPECT_EQ(count, found.size()) << "seed " << seed;
    EXPECT_EQ(portions.counters().bytes_skipped, single.counters().bytes_skipped) << "seed " << seed;
    portions.reset();
    EXPECT_EQ(portions.counters().bytes_skipped + framed, stream.size()) << "seed " << seed;
  }
}

}  // namespace ifog

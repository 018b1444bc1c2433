// SPDX-License-Identifier: Apache-2.0
// A stream of frames of which some are damaged in every way a line can, and the proof that a finder of frames
// takes every intact one out of it, with its own last byte, however the stream is cut into portions.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <vector>

namespace ifog {

using Bytes = std::vector<std::uint8_t>;
using Random = std::mt19937;

// What a test knows of its protocol by itself.
struct Frames {
  std::function<Bytes(Random&)> frame;   // any intact frame
  std::function<Bytes(Random&)> header;  // the beginning of one, whatever it announces
  // The length of the intact frame that these bytes begin with; 0: none. Nothing shared with the code under
  // test.
  std::function<std::size_t(std::span<const std::uint8_t>)> length;
};

class DamagedStream {
 public:
  DamagedStream(const Frames& frames, std::uint32_t seed, int segments) : frames_(frames), random_(seed) {
    for (int i = 0; i < segments; ++i) segment();
    put(frames_.frame(random_));
  }
  Bytes bytes;

 private:
  std::size_t below(std::size_t n) { return random_() % n; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(below(256)); }
  void put(const Bytes& more) { bytes.insert(bytes.end(), more.begin(), more.end()); }
  void cut() {
    Bytes f = frames_.frame(random_);
    f.resize(below(f.size()));
    put(f);
  }
  void noise() {
    for (std::size_t n = below(60); n > 0; --n) {
      if (below(10) == 0) put(frames_.header(random_));
      bytes.push_back(byte());
    }
  }
  void segment() {
    Bytes f = frames_.frame(random_);
    const std::size_t kind = below(8), times = 1 + below(4);
    if (kind == 3) return cut();
    if (kind == 4) return noise();
    if (kind == 5) return cut(), put(f);  // a frame whose tail an intact one has written over
    for (std::size_t n = 0; n < times; ++n) {
      if (kind == 0) f[below(f.size())] ^= static_cast<std::uint8_t>(1 + below(255));
      if (kind == 1) f.insert(f.begin() + static_cast<std::ptrdiff_t>(1 + below(f.size() - 1)), byte());
      if (kind == 2) f.erase(f.begin() + static_cast<std::ptrdiff_t>(below(f.size())));
    }
    put(f);
  }

  const Frames& frames_;
  Random random_;
};

// `Finder` as drivers/plugins/framing/frame_finder.h, `make` makes one. What is intact is found by trying
// every position; damage can by chance leave a frame whole.
template <typename Make>
void every_intact_frame_comes_out(const Frames& frames, int seeds, Make&& make) {
  struct Placed {
    std::size_t end;
    Bytes bytes;
    bool operator==(const Placed&) const = default;
  };
  for (int seed = 1; seed <= seeds; ++seed) {
    const Bytes stream = DamagedStream(frames, static_cast<std::uint32_t>(seed), 60).bytes;
    std::vector<Placed> present;
    std::size_t framed = 0;
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t n = frames.length(std::span(stream).subspan(at));
      if (n != 0) {
        const auto begin = stream.begin() + static_cast<std::ptrdiff_t>(at);
        present.push_back({at + n, {begin, begin + static_cast<std::ptrdiff_t>(n)}});
      }
      framed += n;
      at += n == 0 ? 1 : n;
    }
    auto single = make();
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

    auto portions = make();
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

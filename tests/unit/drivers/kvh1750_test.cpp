// SPDX-License-Identifier: Apache-2.0
// The frame layout against bytes that our encoder did not make: the standard's check value and frames packed
// by hand from the maker's description, the CRC by the bit-serial definition.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/host/driver_instance.h"
#include "drivers/plugins/framing/crc32_mpeg2.h"
#include "drivers/plugins/kvh1750/frame.h"
#include "drivers/plugins/kvh1750/frame_finder.h"
#include "tests/unit/drivers/hex_bytes.h"

namespace {

using ifog::framing::crc32_mpeg2;
using ifog::kvh::Frame;

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// Long division, one bit at a time, as the definition reads: no table, nothing shared with the code under
// test.
std::uint32_t long_division(std::span<const std::uint8_t> bytes) {
  std::uint32_t remainder = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes)
    for (int bit = 7; bit >= 0; --bit) {
      const bool in = ((byte >> bit) & 1) != 0;
      const bool out = (remainder >> 31U) != 0;
      remainder <<= 1U;
      if (in != out) remainder ^= 0x04C11DB7U;
    }
  return remainder;
}

void append_crc(std::vector<std::uint8_t>& frame) {
  const std::uint32_t crc = long_division(frame);
  for (int shift = 24; shift >= 0; shift -= 8) frame.push_back(static_cast<std::uint8_t>(crc >> shift));
}

TEST(Crc32Mpeg2, HasTheCatalogueCheckValue) { EXPECT_EQ(crc32_mpeg2(bytes_of("123456789")), 0x0376E6E7U); }

TEST(Crc32Mpeg2, EqualsLongDivision) {
  std::vector<std::uint8_t> bytes;
  for (unsigned i = 0; i < 300; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(i * 37 + i / 7));
    ASSERT_EQ(crc32_mpeg2(bytes), long_division(bytes)) << i;
  }
}

// ------------------------------------------------------------------------------------------------------------------
// Frames packed by hand from the tables of the maker's manual; the CRCs at their ends come from long division
// done outside this program.

std::vector<std::uint8_t> hex(std::string_view text) { return ifog::hex_bytes(text); }

//                                 header    gyro 1, -2, 0.5             accelerometer 0, 1, -1      st sq 25
//                                 CRC
const std::string_view kFrameA =
    "FE81FF55 3F800000 C0000000 3F000000 00000000 3F800000 BF800000 77 05 0019 F6EB3358";
//                                           0.1      -0.1     NaN       3.1415927, 0, -1       12 s     st sq
//                                           -10
const std::string_view kFrameB =
    "FE81FF56 3DCCCCCD BDCCCCCD 7FC00000 40490FDB 00000000 BF800000 00B71B00 73 7F FFF6 3736CF8E";
//                                                                                              0.49 gauss, y
const std::string_view kFrameC =
    "FE81FF57 3F800000 C0000000 3F000000 00000000 3F800000 BF800000 3EFAE148 77 06 DCB3C67E";

std::vector<ifog_sample> decode(ifog::DriverInstance& driver, const std::vector<std::uint8_t>& bytes,
                                std::int64_t arrival_ns = 42) {
  std::vector<ifog_sample> samples;
  driver.decode_bytes(bytes, arrival_ns, [&](const ifog_sample& sample) { samples.push_back(sample); });
  return samples;
}

TEST(Kvh1750, FormatAPackedByHand) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {});
  const std::vector<ifog_sample> samples = decode(driver, hex(kFrameA));
  ASSERT_EQ(samples.size(), 1U);
  const ifog_sample& s = samples[0];
  EXPECT_EQ(s.arrival_ns, 42);
  EXPECT_EQ(s.flags, IFOG_SAMPLE_SEQUENCE);
  EXPECT_EQ(s.sequence, 5U);
  EXPECT_EQ(s.status, 0x77U);
  EXPECT_EQ(s.valid_axes, 7U);
  EXPECT_EQ(s.value[0], 1.0);
  EXPECT_EQ(s.value[1], -2.0);
  EXPECT_EQ(s.value[2], 0.5);
  EXPECT_EQ(s.environment_fresh, 0b1111U);
  EXPECT_EQ(s.environment[0], 0.0);
  EXPECT_EQ(s.environment[1], 9.80665);
  EXPECT_EQ(s.environment[2], -9.80665);
  EXPECT_EQ(s.environment[3], 25.0);
  EXPECT_TRUE(std::isnan(s.environment[4]));
}

// The sample output printed in the maker's 1775 IMU technical manual (section 5.2.1), which also breaks it
// down: delta angles in radians, about −1 g along x, all valid, sequence 61, 40 °C.
TEST(Kvh1750, TheManualsSampleOutput) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"output", "delta"}});
  const std::vector<ifog_sample> samples = decode(
      driver, hex("FE81FF55 37A96A6E 38586C1F B75BF862 BF803E78 BB650D28 3B0A37AC 77 3D 0028 4BFA34D8"));
  ASSERT_EQ(samples.size(), 1U);
  const ifog_sample& s = samples[0];
  EXPECT_EQ(driver.description().kind, unsigned{IFOG_DELTA_ANGLE});
  EXPECT_NEAR(s.value[0], 2.019593e-5, 1e-11);
  EXPECT_NEAR(s.value[1], 5.159911e-5, 1e-11);
  EXPECT_NEAR(s.value[2], -1.311125e-5, 1e-11);
  EXPECT_NEAR(s.environment[0], -1.0019064 * 9.80665, 1e-6);
  EXPECT_EQ(s.valid_axes, 7U);
  EXPECT_EQ(s.sequence, 61U);
  EXPECT_EQ(s.environment[3], 40.0);
}

TEST(Kvh1750, FormatBPackedByHand) {
  ifog::DriverInstance driver = ifog::make_driver(
      "kvh1750", {{"format", "b"}, {"angle_unit", "degrees"}, {"temperature", "centi_degC"}});
  const std::vector<ifog_sample> samples = decode(driver, hex(kFrameB));
  ASSERT_EQ(samples.size(), 1U);
  const ifog_sample& s = samples[0];
  EXPECT_EQ(s.flags, unsigned{IFOG_SAMPLE_SEQUENCE | IFOG_SAMPLE_DEVICE_TIME});
  EXPECT_EQ(s.device_time_ns, 12'000'000'000);
  EXPECT_EQ(s.sequence, 127U);
  // 0x73: the device calls gyro z invalid, and it is no number either.
  EXPECT_EQ(s.valid_axes, 0b011U);
  EXPECT_DOUBLE_EQ(s.value[0], static_cast<double>(0.1F) * 3.14159265358979323846 / 180.0);
  EXPECT_NEAR(s.environment[0], 3.14159265 * 9.80665, 1e-6);
  EXPECT_DOUBLE_EQ(s.environment[3], -0.1);
}

TEST(Kvh1750, FormatCPackedByHand) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"format", "c"}});
  const std::vector<ifog_sample> samples = decode(driver, hex(kFrameC));
  ASSERT_EQ(samples.size(), 1U);
  const ifog_sample& s = samples[0];
  EXPECT_EQ(s.sequence, 6U);  // modulo four: 2, the field along y
  EXPECT_EQ(s.environment_fresh, 0b0100111U);
  EXPECT_NEAR(s.environment[5], 49.0, 1e-5);  // µT
  EXPECT_TRUE(std::isnan(s.environment[3]));
  EXPECT_TRUE(std::isnan(s.environment[4]));
}

TEST(Kvh1750, AnInvalidStatusBitInvalidatesItsAxisOnly) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {});
  std::vector<std::uint8_t> frame = hex(kFrameA);
  frame.resize(32);
  frame[28] = 0x25;  // gyro x and z, accelerometer y
  append_crc(frame);
  const std::vector<ifog_sample> samples = decode(driver, frame);
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].valid_axes, 0b101U);
  EXPECT_EQ(samples[0].environment_fresh, 0b1010U);
}

TEST(Kvh1750, AnotherFormatThanConfiguredIsCountedNotTaken) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"format", "a"}});
  EXPECT_TRUE(decode(driver, hex(kFrameB)).empty());
  EXPECT_EQ(decode(driver, hex(kFrameA)).size(), 1U);
  EXPECT_EQ(driver.counters().frames_format, 1U);
  EXPECT_EQ(driver.counters().frames_good, 1U);
  EXPECT_EQ(driver.counters().bytes_skipped, 0U);
}

TEST(Kvh1750, TheStampIsPassedOnAsSentWithWhereItGoesRound) {
  for (const auto& [set, wrap_ns] :
       {std::pair("free", (std::int64_t{1} << 32U) * 1000), std::pair("pps", std::int64_t{1'000'000'000})}) {
    ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"format", "b"}, {"time_stamp", set}});
    for (const std::uint32_t stamp_us : {0xFFFFFF00U, 0x000000F4U, 0xFFFFFF00U}) {
      std::vector<std::uint8_t> frame = hex(kFrameB);
      frame.resize(36);
      for (unsigned i = 0; i < 4; ++i) frame[28 + i] = static_cast<std::uint8_t>(stamp_us >> (24U - 8U * i));
      append_crc(frame);
      const ifog_sample sample = decode(driver, frame, 1).at(0);
      EXPECT_EQ(sample.device_time_ns, std::int64_t{stamp_us} * 1000);
      EXPECT_EQ(sample.device_wrap_ns, wrap_ns);
    }
  }
}

// ------------------------------------------------------------------------------------------------------------------
// Every intact frame is recovered from a damaged stream.

struct Placed {
  std::size_t end;  // offset behind its last byte
  std::vector<std::uint8_t> bytes;
};

class DamagedStream {
 public:
  explicit DamagedStream(std::uint32_t seed) : random_(seed) {}

  std::vector<std::uint8_t> bytes;
  std::vector<Placed> intact;

  void build(int segments) {
    for (int i = 0; i < segments; ++i) {
      switch (below(8)) {
        case 0:
          flip();
          break;
        case 1:
          insert();
          break;
        case 2:
          erase();
          break;
        case 3:
          cut();
          break;
        case 4:
          noise();
          break;
        case 5:
          overlaid();
          break;
        default:
          good();
          break;
      }
    }
    good();
  }

 private:
  std::size_t below(std::size_t n) { return random_() % n; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(below(256)); }

  std::vector<std::uint8_t> frame() {
    const auto last = static_cast<std::uint8_t>(0x55 + below(3));
    const std::size_t covered = last == 0x55 ? 32 : last == 0x56 ? 36 : 34;
    std::vector<std::uint8_t> f{0xFE, 0x81, 0xFF, last};
    while (f.size() < covered) {
      // One payload in four holds a header.
      if (f.size() + 4 <= covered && below(32) == 0)
        f.insert(f.end(), {0xFE, 0x81, 0xFF, static_cast<std::uint8_t>(0x55 + below(3))});
      else
        f.push_back(byte());
    }
    append_crc(f);
    return f;
  }

  void put(const std::vector<std::uint8_t>& f) { bytes.insert(bytes.end(), f.begin(), f.end()); }
  void good() {
    const std::vector<std::uint8_t> f = frame();
    put(f);
    intact.push_back({bytes.size(), f});
  }
  void flip() {
    std::vector<std::uint8_t> f = frame();
    for (std::size_t n = 1 + below(3); n > 0; --n)
      f[below(f.size())] ^= static_cast<std::uint8_t>(1 + below(255));
    put(f);
  }
  void insert() {
    std::vector<std::uint8_t> f = frame();
    for (std::size_t n = 1 + below(5); n > 0; --n)
      f.insert(f.begin() + static_cast<std::ptrdiff_t>(1 + below(f.size() - 1)), byte());
    put(f);
  }
  void erase() {
    std::vector<std::uint8_t> f = frame();
    for (std::size_t n = 1 + below(5); n > 0; --n)
      f.erase(f.begin() + static_cast<std::ptrdiff_t>(below(f.size())));
    put(f);
  }
  void cut() {
    std::vector<std::uint8_t> f = frame();
    f.resize(below(f.size()));
    put(f);
  }
  void noise() {
    for (std::size_t n = below(60); n > 0; --n) {
      if (below(10) == 0) put({0xFE, 0x81, 0xFF, static_cast<std::uint8_t>(0x55 + below(3))});
      bytes.push_back(byte());
    }
  }
  // A frame whose tail is overwritten by the beginning of an intact one.
  void overlaid() {
    cut();
    good();
  }

  std::mt19937 random_;
};

// What is there, by trying every position; damage can by chance leave a frame whole, so this may hold more
// than what was put in undamaged.
std::vector<Placed> present_in(const std::vector<std::uint8_t>& stream) {
  std::vector<Placed> present;
  for (std::size_t at = 0; at + 36 <= stream.size();) {
    const std::uint8_t* p = stream.data() + at;
    const std::size_t length = p[3] == 0x55 ? 36 : p[3] == 0x56 ? 40 : p[3] == 0x57 ? 38 : 0;
    if (p[0] == 0xFE && p[1] == 0x81 && p[2] == 0xFF && length != 0 && at + length <= stream.size()) {
      std::vector<std::uint8_t> body(p, p + length - 4);
      append_crc(body);
      if (std::equal(body.begin(), body.end(), p)) {
        present.push_back({at + length, body});
        at += length;
        continue;
      }
    }
    ++at;
  }
  return present;
}

TEST(Kvh1750, EveryIntactFrameComesOutOfADamagedStreamWithItsLastByte) {
  for (std::uint32_t seed = 1; seed <= 300; ++seed) {
    DamagedStream stream(seed);
    stream.build(60);

    const std::vector<Placed> present = present_in(stream.bytes);
    ifog::kvh::FrameFinder finder;
    std::vector<Placed> found;
    std::size_t good_bytes = 0;
    for (std::size_t i = 0; i < stream.bytes.size(); ++i)
      finder.feed({&stream.bytes[i], 1}, [&](std::span<const std::uint8_t> seen) {
        const Frame frame = ifog::kvh::unpack_found(seen);
        std::array<std::uint8_t, ifog::kvh::kLongestFrame> packed{};
        const std::size_t length = pack(frame, packed);
        good_bytes += length;
        found.push_back({i + 1, {packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(length)}});
      });

    ASSERT_EQ(found.size(), present.size()) << "seed " << seed;
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(found[i].end, present[i].end) << "seed " << seed << " frame " << i;
      ASSERT_EQ(found[i].bytes, present[i].bytes) << "seed " << seed << " frame " << i;
    }
    std::size_t at = 0;
    for (const Placed& frame : stream.intact) {
      while (at < found.size() && found[at].end != frame.end) ++at;
      ASSERT_LT(at, found.size()) << "seed " << seed << ": the frame ending at byte " << frame.end
                                  << " is missing";
      ASSERT_EQ(found[at].bytes, frame.bytes);
    }
    EXPECT_EQ(good_bytes + finder.counters().bytes_skipped + finder.waiting(), stream.bytes.size());
    EXPECT_EQ(finder.counters().intact, found.size());

    // The same in portions of any size, larger than the buffer too.
    ifog::kvh::FrameFinder portions;
    std::mt19937 random(seed);
    std::size_t count = 0;
    for (std::size_t i = 0; i < stream.bytes.size();) {
      const std::size_t n =
          std::min<std::size_t>(1 + random() % (seed % 2 == 0 ? 50 : 9000), stream.bytes.size() - i);
      portions.feed({&stream.bytes[i], n}, [&](std::span<const std::uint8_t>) { ++count; });
      i += n;
    }
    EXPECT_EQ(count, found.size()) << "seed " << seed;
    EXPECT_EQ(portions.counters().bytes_skipped, finder.counters().bytes_skipped);
  }
}

// ------------------------------------------------------------------------------------------------------------------
// The encoder against the decoder, which the tests above hold to the manual.

TEST(Kvh1750, EncodesTheHandPackedFramesAgain) {
  for (const auto& [format, text] : {std::pair{"a", kFrameA}, {"b", kFrameB}}) {
    ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"format", format}});
    const std::vector<std::uint8_t> bytes = hex(text);
    std::vector<std::uint8_t> again;
    driver.encode_bytes(decode(driver, bytes).at(0), again);
    EXPECT_EQ(again, bytes) << format;
  }
}

TEST(Kvh1750, EncodeRefusesWhatTheFormatCannotHold) {
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"temperature", "centi_degC"}});
  ifog_sample sample{};
  sample.environment[3] = 400.0;
  std::vector<std::uint8_t> bytes;
  try {
    driver.encode_bytes(sample, bytes);
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(
        error.what(),
        "driver kvh1750: temperature_degC is 400.000000, expected what 16 bits hold in the temperature "
        "option's scale");
  }
  EXPECT_TRUE(bytes.empty());
}

}  // namespace

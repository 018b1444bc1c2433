// SPDX-License-Identifier: Apache-2.0
// The DBC reader and the bit layouts: against vectors worked out by hand, and against a second method that
// follows the format's definition one bit at a time.
#include "drivers/dbc/codec.h"
#include "drivers/dbc/database.h"
#include "tests/unit/test.h"

namespace {

using ifog::dbc::ByteOrder;
using ifog::dbc::Database;
using ifog::dbc::Message;
using ifog::dbc::parse_database;
using ifog::dbc::Signal;
using ifog::dbc::ValueType;

Signal laid_out(std::uint32_t start, std::uint32_t length, ByteOrder order, ValueType type) {
  Signal s;
  s.start_bit = start;
  s.length = length;
  s.order = order;
  s.type = type;
  return s;
}

// The definition: bit n of a frame is bit n % 8 of byte n / 8. Little-endian: the value's bit i is frame bit
// start + i. Big-endian: the value's top bit is frame bit start, and each next one lies one lower in its
// byte, or after bit 0 of a byte at bit 7 of the byte behind.
std::uint64_t by_definition(const Signal& s, const std::array<std::uint8_t, 64>& data) {
  const auto bit = [&](std::uint32_t n) { return static_cast<std::uint64_t>(data[n / 8] >> (n % 8)) & 1U; };
  std::uint64_t value = 0;
  if (s.order == ByteOrder::kLittle) {
    for (std::uint32_t i = 0; i < s.length; ++i) value |= bit(s.start_bit + i) << i;
  } else {
    std::uint32_t n = s.start_bit;
    for (std::uint32_t i = 0; i < s.length; ++i) {
      value = value << 1U | bit(n);
      n = n % 8 == 0 ? n + 15 : n - 1;
    }
  }
  return value;
}

TEST(DbcCodec, SignedAndFloatingValues) {
  const std::array<std::uint8_t, 8> data{0xFE, 0xFF, 0xC0, 0x20, 0x00, 0x00, 0x00, 0x08};
  EXPECT_EQ(physical(laid_out(0, 16, ByteOrder::kLittle, ValueType::kSigned), 0xFFFE), -2.0);
  EXPECT_EQ(physical(laid_out(0, 12, ByteOrder::kLittle, ValueType::kSigned), 0x800), -2048.0);
  EXPECT_EQ(physical(laid_out(0, 12, ByteOrder::kLittle, ValueType::kSigned), 0x7FF), 2047.0);
  EXPECT_EQ(physical(laid_out(0, 64, ByteOrder::kLittle, ValueType::kSigned), ~std::uint64_t{0}), -1.0);
  // 0xC0200000 is -2.5 in IEEE 754.
  const Signal f = laid_out(23, 32, ByteOrder::kBig, ValueType::kFloat);
  EXPECT_EQ(physical(f, raw_bits(f, data)), -2.5);
  EXPECT_EQ(physical(laid_out(0, 64, ByteOrder::kLittle, ValueType::kDouble), 0x400921FB54442D18U),
            3.141592653589793);
  Signal scaled = laid_out(0, 16, ByteOrder::kLittle, ValueType::kSigned);
  scaled.scale = 0.01;
  scaled.offset = -40.0;
  EXPECT_DOUBLE_EQ(physical(scaled, 0xFFFE), -40.02);
  EXPECT_EQ(raw_of(scaled, -40.02), 0xFFFEU);
}

TEST(DbcCodec, EveryLayoutReadsAsTheDefinitionSays) {
  std::mt19937_64 random(7);
  int checked = 0;
  for (int i = 0; i < 20000; ++i) {
    std::array<std::uint8_t, 64> data{};
    for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
    const auto order = random() % 2 == 0 ? ByteOrder::kLittle : ByteOrder::kBig;
    Signal s = laid_out(static_cast<std::uint32_t>(random() % 512),
                        static_cast<std::uint32_t>(1 + random() % 64), order, ValueType::kUnsigned);
    Message m;
    m.length = 64;
    m.signals = {s};
    const Database database;
    try {
      check_fits(database, m, s);
    } catch (const std::runtime_error&) {
      continue;
    }
    ++checked;
    ASSERT_EQ(raw_bits(s, data), by_definition(s, data)) << s.start_bit << "|" << s.length;
    // Writing changes these bits and no others.
    std::array<std::uint8_t, 64> other = data;
    const std::uint64_t value =
        random() & (s.length == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << s.length) - 1);
    set_raw_bits(s, value, other);
    ASSERT_EQ(by_definition(s, other), value);
    set_raw_bits(s, raw_bits(s, data), other);
    ASSERT_EQ(other, data);
    ASSERT_LE(bytes_needed(s), 64U);
  }
  EXPECT_GT(checked, 15000);
}

TEST(DbcCodec, RefusesValuesOutOfRange) {
  Signal s = laid_out(0, 8, ByteOrder::kLittle, ValueType::kSigned);
  s.name = "Temp";
  EXPECT_EQ(raw_of(s, 127.4), 127U);
  EXPECT_EQ(raw_of(s, -128.0), 0x80U);
  EXPECT_THROW((void)raw_of(s, 127.5), std::invalid_argument);
  EXPECT_THROW((void)raw_of(s, std::nan("")), std::invalid_argument);
  EXPECT_THROW((void)raw_of(laid_out(0, 32, ByteOrder::kLittle, ValueType::kFloat), 1e39),
               std::invalid_argument);
}

// What editors write around the part that matters.
constexpr const char* kFile = R"dbc(VERSION "HNPBNYYYYYYYYYNNNNNNNNNN/4/%%%/4/'%**4YYY///"


NS_ :
	NS_DESC_
	CM_
	BA_DEF_
	BA_
	VAL_
	SG_MUL_VAL_

BS_: 500000 : 1,2

BU_: Gyro  ECU

VAL_TABLE_ OnOff 1 "on" 0 "off; BO_ 9 No: 8 X" ;

BO_ 2147484672 Gyro_Box: 8 Gyro
 SG_ Angle : 0|32@1- (1,0) [-4|4] "rad" ECU,Vector__XXX
 SG_ Temperature : 39|16@0- (0.01,-5) [-40|85] "degC"  ECU

BO_ 100 Mux: 8 Vector__XXX
 SG_ Selector M : 0|8@1+ (1,0) [0|0] "" Vector__XXX
 SG_ Low m0 : 8|16@1- (1E-3,0) [0|0] "rad/s" Vector__XXX
 SG_ Sub m1M : 8|8@1+ (1,0) [0|0] "" Vector__XXX
 SG_ Deep m7 : 16|32@1- (1,0) [0|0] "" Vector__XXX

BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX
 SG_ Left_over : 0|16@1+ (1,0) [0|0] "" Vector__XXX

CM_ SG_ 2147484672 Angle "several
lines; with a BO_ 5 Fake: 8 X and a \"quote\"";
BA_DEF_ BO_  "GenMsgCycleTime" INT 0 65535;
BA_ "GenMsgCycleTime" BO_ 100 10;
VAL_ 100 Selector 0 "low" 1 "sub" ;
SIG_VALTYPE_ 2147484672 Angle : 1;
SG_MUL_VAL_ 100 Deep Sub 7-7, 9-11;
)dbc";

TEST(DbcFile, ReadsMessagesAndSignalsAndSkipsTheRest) {
  const Database d = parse_database(kFile, "bus.dbc");
  ASSERT_EQ(d.messages.size(), 3U);
  const Message& box = d.messages[0];
  EXPECT_EQ(box.name, "Gyro_Box");
  EXPECT_TRUE(box.extended);
  EXPECT_EQ(box.id, 1024U);
  ASSERT_EQ(box.signals.size(), 2U);
  EXPECT_EQ(box.signals[0].type, ValueType::kFloat);
  EXPECT_EQ(box.signals[0].unit, "rad");
  EXPECT_EQ(box.signals[1].order, ByteOrder::kBig);
  EXPECT_EQ(box.signals[1].type, ValueType::kSigned);
  EXPECT_EQ(box.signals[1].start_bit, 39U);
  EXPECT_EQ(box.signals[1].scale, 0.01);
  EXPECT_EQ(box.signals[1].offset, -5.0);
  EXPECT_EQ(box.signals[1].line, 20U);
  const Message& mux = d.messages[1];
  EXPECT_FALSE(mux.extended);
  EXPECT_TRUE(mux.signals[0].selects);
  EXPECT_EQ(mux.signals[1].selector, 0U);
  EXPECT_EQ(mux.signals[1].scale, 1e-3);
  EXPECT_EQ(mux.signals[3].selector, 2U);
}

TEST(DbcFile, NestedMultiplexorsSelect) {
  const Database d = parse_database(kFile, "bus.dbc");
  const Message& m = d.messages[1];
  const auto there = [&](std::size_t signal, std::uint8_t first, std::uint8_t second) {
    const std::array<std::uint8_t, 8> data{first, second};
    return selected(m, m.signals[signal], data);
  };
  EXPECT_TRUE(there(1, 0, 0));
  EXPECT_FALSE(there(1, 1, 0));
  EXPECT_TRUE(there(3, 1, 7));
  EXPECT_TRUE(there(3, 1, 10));
  EXPECT_FALSE(there(3, 1, 8));
  EXPECT_FALSE(there(3, 0, 7));  // the selector of the selector says otherwise
  EXPECT_FALSE(selected(m, m.signals[3], {}));
}

std::string refusal(const std::string& text) {
  return ifog::test::refusal([&] {
    const Database d = parse_database(text, "f.dbc");
    for (const Message& m : d.messages)
      for (const Signal& s : m.signals) check_fits(d, m, s);
  });
}

TEST(DbcFile, RefusesWithFileAndLine) {
  EXPECT_EQ(refusal("VERSION \"\"\nBO_ 1 A 8 X\n"), "f.dbc:2: '8 X', expected ':'");
  EXPECT_EQ(refusal("BO_ 1 A: 8 X\n SG_ S : 0|32@1+ (1,0) [0|0"), "f.dbc:2: the file ends, expected ']'");
  EXPECT_EQ(refusal("BO_ 4096 A: 8 X\n"),
            "f.dbc:1: message A has id 4096, expected at most 11 bits, or 29 bits and bit 31 set");
  EXPECT_EQ(refusal("BO_ 1 A: 4 X\n SG_ S : 24|16@1+ (1,0) [0|0] \"\" X\n"),
            "f.dbc:2: signal A.S reaches beyond the 4 bytes of its message");
  EXPECT_EQ(refusal("BO_ 1 A: 2 X\n SG_ S : 7|17@0+ (1,0) [0|0] \"\" X\n"),
            "f.dbc:2: signal A.S reaches beyond the 2 bytes of its message");
  EXPECT_EQ(refusal("BO_ 1 A: 8 X\n SG_ S : 0|16@1+ (0,0) [0|0] \"\" X\n"),
            "f.dbc:2: signal A.S has factor 0, expected any other number");
  EXPECT_EQ(refusal("BO_ 1 A: 8 X\n SG_ S : 0|24@1- (1,0) [0|0] \"\" X\nSIG_VALTYPE_ 1 S : 1;"),
            "f.dbc:3: signal S is a float of 24 bits, expected 32");
  EXPECT_EQ(refusal("BO_ 1 A: 8 X\n SG_ S m1 : 0|16@1- (1,0) [0|0] \"\" X\n"),
            "f.dbc:2: signal S is multiplexed, but message A has no multiplexor (M)");
}

}  // namespace

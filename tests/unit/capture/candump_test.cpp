// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/candump/candump.h"
#include "tests/unit/test.h"

namespace {

using ifog::CandumpEntry;
using ifog::CandumpLine;

// Lines of candump(1) and canplayer(1) of can-utils, and what candump 2020.11 prints on the screen: candump [-t a|d|z]
// [-a] [-x] [-e] can0.
TEST(CandumpParser, ReadsTheLinesOfTheManualPagesAndOfTheScreen) {
  constexpr int kFd = IFOG_CAN_EXTENDED | IFOG_CAN_FD | IFOG_CAN_BRS;
  struct Row {
    const char* line;
    std::int64_t arrival_ns;
    const char* interface;
    std::uint32_t id;
    int flags;
    std::vector<std::uint8_t> data;
  };
  const std::vector<std::uint8_t> twelve{0xaa, 0xbb, 0xcc, 0xdd, 0xee, 0xff,
                                         0x00, 0x11, 0x22, 0x33, 0x44, 0x55};
  for (const Row& row : {
           Row{"(1345212884.318850) vcan0 123#112233",
               1'345'212'884'318'850'000,
               "vcan0",
               0x123,
               0,
               {0x11, 0x22, 0x33}},
           Row{"(0.5) can1 1F334455##1aabbccddeeff001122334455", 500'000'000, "can1", 0x1F334455, kFd,
               twelve},
           Row{"(1.123456789) can0 00000001#", 1'123'456'789, "can0", 1, IFOG_CAN_EXTENDED, {}},
           Row{"(1.0) can0 123#11_F", 1'000'000'000, "can0", 0x123, 0, {0x11}},
           Row{"(1.0) can0 123#11 T\r", 1'000'000'000, "can0", 0x123, 0, {0x11}},
           Row{" (000.000123)  can0  123   [2]  27 20   '' '", 123'000, "can0", 0x123, 0, {0x27, 0x20}},
           Row{"  can0  123   [0]", 0, "can0", 0x123, 0, {}},
           Row{"  can0  123  [12]  AA BB CC DD EE FF 00 11 22 33 44 55", 0, "can0", 0x123, IFOG_CAN_FD,
               twelve},
           // Standard ids are indented once an extended one has come.
           Row{"  can0       123   [1]  11", 0, "can0", 0x123, 0, {0x11}},
       }) {
    CandumpEntry e;
    ASSERT_EQ(ifog::parse_candump_line(row.line, e), CandumpLine::frame) << row.line;
    EXPECT_EQ(e.frame.arrival_ns, row.arrival_ns) << row.line;
    EXPECT_EQ(e.interface, row.interface) << row.line;
    EXPECT_EQ(e.frame.id, row.id) << row.line;
    EXPECT_EQ(e.frame.flags, row.flags) << row.line;
    EXPECT_TRUE(std::ranges::equal(std::span(e.frame.data, e.frame.length), row.data)) << row.line;
  }
}

TEST(CandumpParser, TellsOtherLinesApart) {
  CandumpEntry e;
  for (const auto& [line, kind] :
       {std::pair{"(1.0) can0 123#R", CandumpLine::remote},
        {"(1.0) can0 123#R5", CandumpLine::remote},
        {"  can0  123   [4]  remote request", CandumpLine::remote},
        {"(1.0) can0 20000004#0004000000000000", CandumpLine::error},
        {"  can0  20000088   [8]  00 00 80 19 00 00 00 00   ERRORFRAME", CandumpLine::error},
        {"\tprotocol-violation{{tx-recessive-bit-error}{}}", CandumpLine::blank},
        {"", CandumpLine::blank},
        {"# remark", CandumpLine::blank}})
    EXPECT_EQ(ifog::parse_candump_line(line, e), kind) << line;
  for (const char* bad :
       {"1.0 can0 123#11", "(1) can0 123#11", "(1.0 can0 123#11", "(1.0) 123#11", "(1.0) can0 12#11",
        "(1.0) can0 800#11", "(1.0) can0 1234#11", "(1.0) can0 123", "(1.0) can0 123#1",
        "(1.0) can0 123#11 x y", "(1.0) can0 123#112233445566778899", "(1.0) can0 123##",
        "(99999999999.0) can0 123#11", "(1.0123456789) can0 123#11", "(1.0) can0 40000000#11",
        "  can0  123   [8]  11 22 33 44 55 66 77", "  can0  123   [8]  11 22 33 44 55 66 77 8",
        "  can0  123   [2]  11 22 33", "  can0  123   [9]  11 22 33 44 55 66 77 88 99", "  can0  123   [8]",
        "  can0  123   8  11", "  can0  123", "  can0", "  can0  12   [1]  11", "  can0  123   [2]  1122",
        "  can0  123   [1]  00010002", "  can0  123   [1]  0001000", "  can0  123   [1]  000100010",
        "  can0  123   [2]  11`", "  can0  123   [3]  11`22 33",
        " (2026-13-01 10:20:30.000001)  can0  123   [1]  11",
        " (2026-05-01 10:20:30.000001  can0  123   [1]  11",
        "DROPCOUNT: dropped x CAN frames on 'can0' socket (total drops 5)", "  can0  123   [1]  11   x",
        "  can0  123   [65]  11", "  can0  123   []  11", " (0.1)  123   [1]  11",
        "  can0  RX -  123   [1]  0F", "  can0  800   [1]  11", "  can0  123   [3]  remote",
        "  can0  123   [1]  1`", "can0 123#11",
        // CAN XL, which no driver reads.
        "(1.0) can0 00123#81:00:12345678#1122"})
    EXPECT_EQ(ifog::parse_candump_line(bad, e), CandumpLine::malformed) << bad;
}

TEST(CandumpParser, WritesWhatCandumpWrites) {
  std::array<char, ifog::kCandumpLineMax> line{};
  ifog_can_frame frame{};
  frame.arrival_ns = 1'345'212'884'318'850'999;
  frame.id = 0x7FF;
  frame.length = 2;
  frame.data[0] = 0x0A;
  frame.data[1] = 0xF0;
  EXPECT_EQ(std::string(line.data(), ifog::format_candump_line(frame, "vcan0", line.data())),
            "(1345212884.318850) vcan0 7FF#0AF0\n");
  frame.id = 0x1ABCDEF0;
  frame.flags = IFOG_CAN_EXTENDED | IFOG_CAN_FD | IFOG_CAN_BRS;
  frame.length = 64;
  const std::string text(line.data(), ifog::format_candump_line(frame, "fifteenletters1", line.data()));
  EXPECT_TRUE(text.starts_with("(1345212884.318850) fifteenletters1 1ABCDEF0##10AF000")) << text;
  CandumpEntry e;
  ASSERT_EQ(ifog::parse_candump_line(std::string_view(text).substr(0, text.size() - 1), e),
            CandumpLine::frame);
  EXPECT_EQ(e.frame.length, 64U);
}

struct Log : ifog::CandumpLosses {
  std::vector<ifog_can_frame> frames;
  std::vector<std::string> on;  // of each frame the interface
};
Log read(const std::string& text, std::string_view interface = {}) {
  ifog::InputFile file("log", text);
  Log log;
  static_cast<ifog::CandumpLosses&>(log) = ifog::for_each_candump_frame(
      file, interface, [](const ifog_can_frame&) { return false; },
      [&](const ifog_can_frame& frame, std::string_view from) {
        log.frames.push_back(frame);
        log.on.emplace_back(from);
      });
  return log;
}

TEST(CandumpFile, RefusesWithFileAndLine) {
  const Log log =
      read("(1.0) can0 123#11\n(1.1) can1 123#22\n(1.2) can0 123#R\n(1.3) can0 20000001#00\n", "can0");
  ASSERT_EQ(log.frames.size(), 1U);
  EXPECT_EQ(log.frames[0].data[0], 0x11);
  EXPECT_EQ(log.on, std::vector<std::string>{"can0"});
  EXPECT_EQ(log.remote, 1U);
  EXPECT_EQ(log.error, 1U);
  EXPECT_EQ(ifog::test::refusal([] { read("(1.0) can0 123#11\n(1.1) can0 123#2\n"); }),
            "log:2: '(1.1) can0 123#2', expected '(seconds.micros) interface id#data' "
            "or 'interface id [length] bytes'");
}

TEST(CandumpFile, TheFirstWantedFramesInterfaceIsFound) {
  const auto second = [](const ifog_can_frame& frame) { return frame.id == 0x124; };
  EXPECT_EQ(ifog::first_interface("# x\n(1.0) vcan1 123#11\n(1.1) can0 124#22\n", second), "can0");
  EXPECT_EQ(ifog::first_interface("(1.0) vcan1 123#11\n(1.1) can0 124#2", second), "");
}

// As lib.c of can-utils (2026) writes them: every view of the same bytes, of every kind of frame.
TEST(CandumpParser, ReadsEveryViewOfTheScreen) {
  CandumpEntry e;
  for (const char* time : {"", " (1777630830.000001)", " (2026-05-01 10:20:30.000001)", " (000.000001)",
                           " (1777630830.000001000)"})
    for (const char* interface : {"can0", "       vcan0", "any", "a_long_interface"})
      for (const char* direction : {"", "  RX - -", "  TX B E", "  TX B -"})
        for (const char* data : {"   [3]  11 22 AB", "   {3}  11 22 AB", "  [03]  11 22 AB",
                                 "   [3]  11 22 AB                     '.\".'"})
          for (const bool extended : {false, true}) {
            std::string line = std::string(time) + "  " + interface + direction + "  " +
                               (extended ? "12345678" : "123") + data;
            ASSERT_EQ(ifog::parse_candump_line(line, e), CandumpLine::frame) << line;
            EXPECT_EQ(e.frame.id, extended ? 0x12345678U : 0x123U) << line;
            EXPECT_EQ(e.frame.flags & IFOG_CAN_EXTENDED, extended ? IFOG_CAN_EXTENDED : 0) << line;
            ASSERT_EQ(e.frame.length, 3U) << line;
            EXPECT_EQ(e.frame.data[0], 0x11) << line;
            EXPECT_EQ(e.frame.data[1], 0x22) << line;
            EXPECT_EQ(e.frame.data[2], 0xAB) << line;
            const std::string name = interface;
            EXPECT_EQ(e.interface, name.substr(name.find_first_not_of(' '))) << line;
            if (std::string(time).size() > 14) {
              EXPECT_EQ(e.frame.arrival_ns, 1'777'630'830'000'001'000) << line;
              EXPECT_EQ(e.stamp, ifog::CandumpStamp::absolute);
            }
          }
}

TEST(CandumpParser, WhatCandumpSaysWasDroppedIsCounted) {
  CandumpEntry e;
  ASSERT_EQ(ifog::parse_candump_line("DROPCOUNT: dropped 1 CAN frame on 'can0' socket (total drops 1)", e),
            CandumpLine::drops);
  EXPECT_EQ(e.dropped, 1U);
  EXPECT_EQ(e.interface, "can0");
  const std::string text =
      "(1.0) can0 123#11\nDROPCOUNT: dropped 5 CAN frames on 'can0' socket (total drops 5)\n(2.0) can0 "
      "123#12\nDROPCOUNT: dropped 7 CAN frames on 'can1' socket (total drops 7)\n(3.0) can0 123#13\n";
  EXPECT_EQ(read(text).frames.size(), 3U);
  EXPECT_EQ(read(text).dropped, 12U);
  EXPECT_EQ(read(text, "can0").dropped, 5U);
}

using Micros = std::vector<std::int64_t>;

Micros micros(const Log& log) {
  Micros out;
  for (const ifog_can_frame& f : log.frames) out.push_back((f.arrival_ns - log.frames[0].arrival_ns) / 1000);
  return out;
}

TEST(CandumpScreen, TimesOfEachKindGoOn) {
  const auto lines = [](const std::vector<const char*>& times, const char* interface = "can0") {
    std::string text;
    for (const char* time : times) text += std::string(" (") + time + ")  " + interface + "  123   [1]  11\n";
    return text;
  };
  // -t d: one is smaller than that before, or all are the same.
  EXPECT_EQ(micros(read(lines({"000.000000", "000.010002", "000.009998", "000.020000"}))),
            (Micros{0, 10002, 20000, 40000}));
  EXPECT_EQ(micros(read(lines({"000.000000", "000.010000", "000.010000", "000.010000"}))),
            (Micros{0, 10000, 20000, 30000}));
  EXPECT_GT(read(lines({"000.000000"})).frames[0].arrival_ns, 0);  // 0 means no time
  // A difference is to the frame before, whatever its interface.
  const std::string both =
      lines({"000.000000"}) + lines({"000.004000"}, "can1") + lines({"000.003000"}) + lines({"000.001000"});
  EXPECT_EQ(micros(read(both, "can0")), (Micros{0, 7000, 8000}));
}

TEST(CandumpScreen, OfALineTooLongTheNumberIsSaid) {
  const std::string begins = "log:2: a line of more than 1048576 bytes, begins 'xxxx";
  for (const char* end : {"", "\n(1.2) can0 123#11\n"}) {
    const std::string text = "(1.0) can0 123#11\n" + std::string(1200000, 'x') + end;
    EXPECT_EQ(ifog::test::refusal([&] { read(text); }).substr(0, begins.size()), begins);
  }
}

// As candump writes them lines have an end; one without it may have lost bytes and still read as a frame.
TEST(CandumpScreen, ALogThatIsCutOffKeepsItsFrames) {
  const std::string whole = "(1.0) can0 123#1122334455667788\n(1.1) can0 123#1122334455667788";
  for (std::size_t length = 33; length <= whole.size(); ++length) {
    const Log log = read(whole.substr(0, length));
    const bool complete = length == whole.size();
    ASSERT_EQ(log.frames.size(), complete ? 2U : 1U) << length;
    ASSERT_EQ(log.cut_off, !complete && length > 32) << length;
  }
  EXPECT_THROW(read("(1.0) can0 12"), std::runtime_error);  // no log at all
}

}  // namespace

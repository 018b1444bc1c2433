#include "drivers/capture/candump.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

namespace {

namespace fs = std::filesystem;
using ifog::CandumpEntry;
using ifog::CandumpLine;

TEST(CandumpParser, ReadsTheLinesOfTheManualPages) {
  CandumpEntry e;
  // candump(1) and canplayer(1) of can-utils.
  ASSERT_EQ(ifog::parse_candump_line("(1345212884.318850) vcan0 123#112233", e), CandumpLine::frame);
  EXPECT_EQ(e.frame.arrival_ns, 1'345'212'884'318'850'000);
  EXPECT_EQ(e.interface, "vcan0");
  EXPECT_EQ(e.frame.id, 0x123U);
  EXPECT_EQ(e.frame.flags, 0U);
  ASSERT_EQ(e.frame.length, 3U);
  EXPECT_EQ(e.frame.data[0], 0x11);
  EXPECT_EQ(e.frame.data[2], 0x33);

  ASSERT_EQ(ifog::parse_candump_line("(0.5) can1 1F334455##1aabbccddeeff001122334455", e),
            CandumpLine::frame);
  EXPECT_EQ(e.frame.arrival_ns, 500'000'000);
  EXPECT_EQ(e.frame.id, 0x1F334455U);
  EXPECT_EQ(e.frame.flags, IFOG_CAN_EXTENDED | IFOG_CAN_FD | IFOG_CAN_BRS);
  EXPECT_EQ(e.frame.length, 12U);
  EXPECT_EQ(e.frame.data[11], 0x55);

  ASSERT_EQ(ifog::parse_candump_line("(1.123456789) can0 00000001#", e), CandumpLine::frame);
  EXPECT_EQ(e.frame.arrival_ns, 1'123'456'789);
  EXPECT_EQ(e.frame.flags, IFOG_CAN_EXTENDED);
  EXPECT_EQ(e.frame.length, 0U);

  EXPECT_EQ(ifog::parse_candump_line("(1.0) can0 123#1122334455667788_F", e), CandumpLine::frame);
  EXPECT_EQ(ifog::parse_candump_line("(1.0) can0 123#11 T\r", e), CandumpLine::frame);
}

TEST(CandumpParser, TellsOtherLinesApart) {
  CandumpEntry e;
  EXPECT_EQ(ifog::parse_candump_line("(1.0) can0 123#R", e), CandumpLine::remote);
  EXPECT_EQ(ifog::parse_candump_line("(1.0) can0 123#R5", e), CandumpLine::remote);
  EXPECT_EQ(ifog::parse_candump_line("(1.0) can0 20000004#0004000000000000", e), CandumpLine::error);
  EXPECT_EQ(ifog::parse_candump_line("", e), CandumpLine::blank);
  EXPECT_EQ(ifog::parse_candump_line("# remark", e), CandumpLine::blank);
  for (const char* bad :
       {"1.0 can0 123#11", "(1) can0 123#11", "(1.0 can0 123#11", "(1.0) 123#11", "(1.0) can0 12#11",
        "(1.0) can0 800#11", "(1.0) can0 1234#11", "(1.0) can0 123", "(1.0) can0 123#1",
        "(1.0) can0 123#11 x y", "(1.0) can0 123#112233445566778899", "(1.0) can0 123##",
        "(99999999999.0) can0 123#11", "(1.0123456789) can0 123#11", "(1.0) can0 40000000#11"})
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

TEST(CandumpFile, RefusesWithFileAndLine) {
  const fs::path path = fs::temp_directory_path() / ("ifog-candump-" + std::to_string(getpid()) + ".log");
  std::ofstream(path) << "(1.0) can0 123#11\n(1.1) can1 123#22\n(1.2) can0 123#R\n(1.3) can0 20000001#00\n";
  const ifog::Candump log = ifog::read_candump(path, "can0");
  ASSERT_EQ(log.frames.size(), 1U);
  EXPECT_EQ(log.frames[0].data[0], 0x11);
  EXPECT_EQ(log.interface, "can0");
  EXPECT_EQ(log.remote, 1U);
  EXPECT_EQ(log.error, 1U);
  std::ofstream(path) << "(1.0) can0 123#11\n(1.1) can0 123#2";
  try {
    ifog::read_candump(path);
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()), path.string() +
                                             ":2: '(1.1) can0 123#2', expected '(seconds.micros) interface "
                                             "id#data' (the file is cut off here)");
  }
  fs::remove(path);
}

}  // namespace

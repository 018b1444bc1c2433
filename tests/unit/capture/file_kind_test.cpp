// SPDX-License-Identifier: Apache-2.0
// What a file is, by its first bytes and its name.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "drivers/capture/recording.h"

namespace ifog {
namespace {

TEST(FileKind, ByNameAndContent) {
  EXPECT_EQ(file_kind("a.csv.gz"), FileKind::capture);
  EXPECT_EQ(file_kind("a.log"), FileKind::candump);
  EXPECT_EQ(file_kind("a.kvh"), FileKind::bytes);
  EXPECT_EQ(file_kind("nothing"), FileKind::unknown);
  const auto kind_of = [](const char* name, const char* text) { return file_kind(InputFile(name, text)); };
  EXPECT_EQ(kind_of("lcmlog-2026-01-01.00", "\xED\xA1\xDA\x01rest"), FileKind::lcm_log);
  // What comes through a pipe has no telling name.
  EXPECT_EQ(kind_of("-", "# made today\r\n\n# by hand\ntime_s,rate_radps\n0,1\n"), FileKind::capture);
  EXPECT_EQ(kind_of("/dev/fd/63", "(1436509052.249713) can0 123#1122AABB\n"), FileKind::candump);
  EXPECT_EQ(kind_of("-", "#"), FileKind::unknown);
  EXPECT_EQ(kind_of("-", ""), FileKind::unknown);
  EXPECT_EQ(kind_of("-", "\xFE\x81\xFF\x55"), FileKind::unknown);
}

// Whatever it is called; what begins like no other kind is by its name, and what that leaves open is text or
// bytes.
TEST(FileKind, AFileIsWhatItBeginsWithMoreThanWhatItIsCalled) {
  const auto kind_of = [](const char* name, std::string text) {
    return file_kind(InputFile(name, std::move(text)));
  };
  for (const char* const name : {"a.txt", "a.dat", "a", "a.asc", "a.log", "a.bin", "A.TXT.GZ"}) {
    EXPECT_EQ(kind_of(name, "time_s,rate_radps\n0,1\n"), FileKind::capture) << name;
    EXPECT_EQ(kind_of(name, "\xEF\xBB\xBF\"time_s\",rate_radps\n0,1\n"), FileKind::capture) << name;
    EXPECT_EQ(kind_of(name, "(1436509052.249713) can0 123#1122AABB\n"), FileKind::candump) << name;
    EXPECT_EQ(kind_of(name, "\xF1IFR"), FileKind::flight) << name;
  }
  // Nor is text that is a capture one of columns in HDF5.
  for (const char* const name : {"a.h5", "a.csv.hdf5"}) {
    EXPECT_FALSE(is_hdf5(InputFile(name, "time_s,rate_radps\n0,1\n"))) << name;
    EXPECT_TRUE(is_hdf5(InputFile(name, "\x89HDF\r\n\x1A\n"))) << name;
    EXPECT_TRUE(is_hdf5(InputFile(name, "a block of the user's own"))) << name;
  }
  EXPECT_TRUE(is_hdf5(InputFile("a.csv", "\x89HDF\r\n\x1A\n")));
  for (const char* const name : {"a.txt", "a.dat", "a"}) {
    EXPECT_EQ(kind_of(name, "t;GyroX\n0;0,5\n"), FileKind::unknown) << name;
    EXPECT_EQ(kind_of(name, std::string("\xFE\x81\xFF\x55\0\1", 6)), FileKind::bytes) << name;
  }
  EXPECT_EQ(kind_of("a.bin", "-0.001  1\r\n"), FileKind::bytes);
  EXPECT_EQ(kind_of("a.CSV", "t;GyroX\n"), FileKind::capture);
  for (const auto& [name, kind] : {std::pair{"A.CSV", FileKind::capture},
                                   {"a.Csv.gz", FileKind::capture},
                                   {"a.csv.GZ", FileKind::capture},
                                   {"a.H5", FileKind::capture},
                                   {"a.LOG", FileKind::candump},
                                   {"a.KVH", FileKind::bytes},
                                   {"a.LCM", FileKind::lcm_log},
                                   {"a.IFR", FileKind::flight},
                                   {".csvx", FileKind::unknown}})
    EXPECT_EQ(file_kind(std::string(name)), kind) << name;
}

}  // namespace
}  // namespace ifog

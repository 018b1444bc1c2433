// SPDX-License-Identifier: Apache-2.0
// What a file is, by its first bytes and its name, and what is written. Packed files, pipes, devices and links are tried
// with every command by system/command_line/streams.py.
#include <fcntl.h>
#include <unistd.h>

#include "drivers/capture/files/input_file.h"
#include "drivers/capture/files/output_file.h"
#include "drivers/capture/recording.h"
#include "tests/unit/test.h"

namespace {

namespace fs = std::filesystem;
using ifog::file_kind;
using ifog::FileKind;
using ifog::InputFile;
using ifog::is_hdf5;

TEST(InputFile, ATextAtHandAndAnEmptyOne) {
  InputFile file("-", "time_s");
  EXPECT_EQ(file.head(), "time_s");
  EXPECT_EQ(file.bytes(), "time_s");
  EXPECT_EQ(file.head(), "");
  EXPECT_FALSE(file.reopens());
  EXPECT_EQ(InputFile("/dev/null").bytes(), "");
}

TEST(InputFile, SaysWhatIsInTheWay) {
  const auto refusal = [](const std::string& path) {
    return ifog::test::refusal([&] { InputFile(path).bytes(); });
  };
  EXPECT_EQ(refusal("/nowhere/f"), "/nowhere/f: cannot open: No such file or directory");
  EXPECT_EQ(
      refusal("/proc/self"),
      "/proc/self: is a folder, expected a file, or the folder of one sensor's flight recordings (.ifr)");
  // The folder that a configuration names: each sensor has its own in it.
  const ifog::test::OwnFolder folder;
  const std::string all = folder.folder();
  for (const std::string sensor : {"/empty", "/tail", "/nose"}) fs::create_directories(all + sensor);
  for (const std::string name :
       {"/nose/00000001-20231114T221320Z.ifr.open", "/tail/00000001-20231114T221320Z.ifr"})
    std::ofstream(all + name).put('\n');
  EXPECT_EQ(
      refusal(all),
      all + ": is a folder, expected a file, or the folder of one sensor's flight recordings (.ifr), as " +
          all + "/nose");
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
  EXPECT_EQ(kind_of("lcmlog-2026-01-01.00", "\xED\xA1\xDA\x01rest"), FileKind::lcm_log);
  EXPECT_EQ(kind_of("-", "# made today\r\n\n# by hand\ntime_s,rate_radps\n0,1\n"), FileKind::capture);
  for (const char* const text : {"", "#", "\xFE\x81\xFF\x55"})
    EXPECT_EQ(kind_of("-", text), FileKind::unknown);
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

// What is written is there whole or not at all.

using ifog::OutputFile;
using ifog::write_file;

class Output : public testing::Test, protected ifog::test::OwnFolder {
 protected:
  static std::string refusal(const std::string& file) {
    return ifog::test::refusal([&] { write_file(file, "new"); });
  }
};

TEST_F(Output, IsNotSeenBeforeItIsWhole) {
  std::ofstream(path("f")) << "old";
  {
    OutputFile file(path("f"));
    file.write("half of the n");
    EXPECT_EQ(content("f"), "old");
    EXPECT_EQ(files(), 1U) << "a file beside it is to be seen";
  }
  EXPECT_EQ(content("f"), "old") << "given up, yet changed";
  OutputFile file(path("f"));
  file.write("ne");
  file.write("w");
  file.finish();
  EXPECT_EQ(content("f"), "new");
  EXPECT_EQ(files(), 1U);
}

TEST_F(Output, SaysWhatIsInTheWay) {
  EXPECT_EQ(refusal(path("no/f")), path("no/f") + ": cannot create: No such file or directory");
  EXPECT_EQ(refusal(folder()), folder() + ": is a folder, expected a file to write");
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  close(ends[0]);
  std::signal(SIGPIPE, SIG_IGN);
  const std::string pipe = "/dev/fd/" + std::to_string(ends[1]);
  EXPECT_EQ(refusal(pipe), pipe + ": cannot write: Broken pipe");
  close(ends[1]);
}

}  // namespace

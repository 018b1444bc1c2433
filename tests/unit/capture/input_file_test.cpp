// SPDX-License-Identifier: Apache-2.0
// Read once, from the start: the same text from a file, a packed file, a pipe, and a packed file in a pipe. What a file
// is, by its first bytes and its name.
#include "drivers/capture/files/input_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <thread>
#include <utility>

#include "drivers/capture/files/output_file.h"
#include "drivers/capture/recording.h"
#include "tests/unit/own_folder.h"
#include "tests/unit/refusal.h"

namespace {

namespace fs = std::filesystem;
using ifog::file_kind;
using ifog::FileKind;
using ifog::InputFile;
using ifog::is_hdf5;

// Longer than the head and than a pipe's buffer, and no two parts alike.
std::string long_text() {
  std::string text;
  for (int i = 0; i < 40000; ++i) text += std::to_string(i) + ',';
  return text;
}

// Reads what is written into a pipe, by the name that a shell gives it.
template <typename Use>
void through_a_pipe(const std::string& bytes, Use&& use) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  std::thread writer([&] {
    for (std::size_t done = 0; done < bytes.size();)
      done += static_cast<std::size_t>(
          std::max<ssize_t>(0, write(ends[1], bytes.data() + done, bytes.size() - done)));
    close(ends[1]);
  });
  InputFile file("/dev/fd/" + std::to_string(ends[0]));
  use(file);
  writer.join();
  close(ends[0]);
}

TEST(InputFile, TheSameTextFromAFileAPackedOneAndPipes) {
  const ifog::test::OwnFolder folder;
  const std::string plain = folder.path("input");
  const std::string packed = plain + ".gz", misnamed = plain + ".csv", text = long_text();
  ifog::write_file(plain, text);
  ifog::write_file(packed, text);
  fs::copy_file(packed, misnamed, fs::copy_options::overwrite_existing);
  EXPECT_LT(fs::file_size(packed), text.size() / 2);
  for (const std::string& name : {plain, packed, misnamed}) {
    InputFile file(name);
    EXPECT_EQ(file.head(), text.substr(0, InputFile::kHead));
    EXPECT_EQ(file.bytes(), text) << name;
    EXPECT_EQ(file.reopens(), name == plain) << name;
  }
  std::string bytes(fs::file_size(packed), '\0');
  std::ifstream(packed, std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  for (const std::string& sent : {text, bytes})
    through_a_pipe(sent, [&](InputFile& file) {
      EXPECT_FALSE(file.reopens());
      EXPECT_EQ(file.head(), text.substr(0, InputFile::kHead));
      std::string begin(5000, '\0');
      EXPECT_EQ(file.read(begin.data(), begin.size()), begin.size());
      EXPECT_EQ(begin + file.bytes(), text);
      EXPECT_EQ(file.bytes(), "");
    });
}

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

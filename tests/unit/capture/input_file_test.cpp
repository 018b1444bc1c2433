// SPDX-License-Identifier: Apache-2.0
// Read once, from the start: the same text from a file, a packed file, a pipe, and a packed file in a pipe.
#include "drivers/capture/files/input_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "drivers/capture/files/text_file.h"

namespace {

namespace fs = std::filesystem;
using ifog::InputFile;

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
  const std::string plain = fs::temp_directory_path() / ("ifog-input-" + std::to_string(getpid()));
  const std::string packed = plain + ".gz", misnamed = plain + ".csv", text = long_text();
  ifog::write_text_file(plain, text);
  ifog::write_text_file(packed, text);
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
  for (const std::string& name : {plain, packed, misnamed}) fs::remove(name);
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
  const auto refusal = [](const std::string& path) -> std::string {
    try {
      InputFile(path).bytes();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal("/nowhere/f"), "/nowhere/f: cannot open: No such file or directory");
  EXPECT_EQ(
      refusal("/proc/self"),
      "/proc/self: is a folder, expected a file, or the folder of one sensor's flight recordings (.ifr)");
  // The folder that a configuration names: each sensor has its own in it.
  const std::string all = fs::temp_directory_path() / ("ifog-input-recordings-" + std::to_string(getpid()));
  for (const std::string sensor : {"/empty", "/tail", "/nose"}) fs::create_directories(all + sensor);
  for (const std::string name :
       {"/nose/00000001-20231114T221320Z.ifr.open", "/tail/00000001-20231114T221320Z.ifr"})
    std::ofstream(all + name).put('\n');
  EXPECT_EQ(
      refusal(all),
      all + ": is a folder, expected a file, or the folder of one sensor's flight recordings (.ifr), as " +
          all + "/nose");
  fs::remove_all(all);
}

}  // namespace

// SPDX-License-Identifier: Apache-2.0
// What is written is there whole or not at all, and nothing that is not a regular file is ever replaced.
#include "drivers/capture/files/output_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/unit/own_folder.h"
#include "tests/unit/refusal.h"

namespace {

namespace fs = std::filesystem;
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

TEST_F(Output, KeepsTheModeAndAsksForTheRight) {
  std::ofstream(path("f")) << "old";
  fs::permissions(path("f"), fs::perms::owner_read | fs::perms::owner_write);
  write_file(path("f"), "new");
  EXPECT_EQ(fs::status(path("f")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  const mode_t before = umask(027);
  write_file(path("g"), "new");
  umask(before);
  EXPECT_EQ(static_cast<unsigned>(fs::status(path("g")).permissions()), 0640U);
}

TEST_F(Output, FollowsLinksToFilesThereAreAndThatAreYetToBe) {
  fs::create_directory(path("there"));
  std::ofstream(path("there/f")) << "old";
  fs::create_symlink("there/f", path("near"));
  fs::create_symlink(path("near"), path("far"));
  write_file(path("far"), "new");
  EXPECT_TRUE(fs::is_symlink(path("far")));
  EXPECT_TRUE(fs::is_symlink(path("near")));
  EXPECT_EQ(content("there/f"), "new");
  fs::create_symlink("there/g", path("dangling"));
  write_file(path("dangling"), "new");
  EXPECT_TRUE(fs::is_symlink(path("dangling")));
  EXPECT_EQ(content("there/g"), "new");
  fs::create_symlink("round", path("round"));
  EXPECT_NE(refusal(path("round")).find("cannot create: Too many levels of symbolic links"),
            std::string::npos)
      << refusal(path("round"));
}

TEST_F(Output, DevicesAndPipesAreWrittenNotReplaced) {
  write_file("/dev/null", "new");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_EQ(refusal("/dev/full"), "/dev/full: cannot write: No space left on device");
  // Root can make a device node: the one that a careless rename would take away.
  if (geteuid() == 0 && mknod(path("null").c_str(), S_IFCHR | 0666, makedev(1, 3)) == 0) {
    write_file(path("null"), "new");
    EXPECT_TRUE(fs::is_character_file(path("null")));
  }
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  std::string got;
  std::thread reader([&] { got = content("fifo"); });
  write_file(path("fifo"), "new");
  reader.join();
  EXPECT_EQ(got, "new");
  EXPECT_TRUE(fs::is_fifo(path("fifo")));
}

TEST_F(Output, OpenDescriptorsAreWrittenWhereTheyAre) {
  const int fd = open(path("f").c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_GE(fd, 0);
  ASSERT_EQ(::write(fd, "one ", 4), 4);
  write_file("/dev/fd/" + std::to_string(fd), "two ");
  write_file("/proc/self/fd/" + std::to_string(fd), "three");
  close(fd);
  EXPECT_EQ(content("f"), "one two three");
  EXPECT_TRUE(ifog::is_standard_output("-"));
  EXPECT_TRUE(ifog::is_standard_output("/dev/stdout"));
  EXPECT_FALSE(ifog::is_standard_output("/dev/stderr"));
  EXPECT_FALSE(ifog::is_standard_output(path("f")));
  EXPECT_FALSE(ifog::is_standard_output(""));
}

TEST_F(Output, OneFileHasOneIdentityUnderAllItsNames) {
  write_file(path("file"), "1");
  fs::create_symlink("file", path("link"));
  fs::create_hard_link(path("file"), path("hard"));
  const auto file = ifog::file_identity(path("file"));
  ASSERT_TRUE(file);
  EXPECT_EQ(ifog::file_identity(path("link")), file);
  EXPECT_EQ(ifog::file_identity(path("hard")), file);
  EXPECT_EQ(ifog::file_identity(path("../") + fs::path(folder()).filename().string() + "/file"), file);
  const int opened = ::open(path("file").c_str(), O_RDONLY | O_CLOEXEC);
  EXPECT_EQ(ifog::file_identity("/dev/fd/" + std::to_string(opened)), file);
  ::close(opened);

  // One that is not there yet has that of the name it will get.
  fs::create_symlink("yet", path("to_yet"));
  const auto yet = ifog::file_identity(path("yet"));
  ASSERT_TRUE(yet);
  EXPECT_EQ(ifog::file_identity(path("to_yet")), yet);
  EXPECT_NE(ifog::file_identity(path("other")), yet);
  EXPECT_NE(yet, file);

  EXPECT_FALSE(ifog::file_identity("/dev/null"));
  EXPECT_FALSE(ifog::file_identity(folder()));
  EXPECT_FALSE(ifog::file_identity(path("none/file")));
}

TEST_F(Output, SaysWhatIsInTheWay) {
  EXPECT_EQ(refusal(path("no/f")), path("no/f") + ": cannot create: No such file or directory");
  EXPECT_EQ(refusal(folder()), folder() + ": is a folder, expected a file to write");
  EXPECT_EQ(refusal(path("x/")), path("x/") + ": cannot create: No such file or directory");
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  close(ends[0]);
  std::signal(SIGPIPE, SIG_IGN);
  const std::string pipe = "/dev/fd/" + std::to_string(ends[1]);
  EXPECT_EQ(refusal(pipe), pipe + ": cannot write: Broken pipe");
  close(ends[1]);
}

}  // namespace

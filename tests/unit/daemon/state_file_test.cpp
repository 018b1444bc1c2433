// SPDX-License-Identifier: Apache-2.0
// Files of a folder that others may write: what stands under a name there is never followed.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/state/state_folder.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

namespace fs = std::filesystem;

class StateFile : public testing::Test, protected test::OwnFolder {
 protected:
  StateFile() {
    fs::create_directory(path("state"));
    write("victim", "secret");
  }

  [[nodiscard]] fs::path victim() const { return path("victim"); }
  [[nodiscard]] fs::path file() const { return path("state/nose.model.toml"); }
  [[nodiscard]] std::string refusal() const {
    return test::refusal([&] { (void)read_state_file(file().string(), 100); }, "read");
  }
};

TEST_F(StateFile, IsWrittenAndReadWhole) {
  write_state_file(file().string(), "one");
  write_state_file(file().string(), "two");
  EXPECT_EQ(read_state_file(file().string(), 100), "two");
  EXPECT_EQ(std::distance(fs::directory_iterator(file().parent_path()), fs::directory_iterator()), 1);
  EXPECT_TRUE(test::has(refusal(), "read"));
  EXPECT_THROW((void)read_state_file(file().string(), 2), std::runtime_error);
}

TEST_F(StateFile, ALinkIsNeitherFollowedNorRead) {
  fs::create_symlink(victim(), file());
  EXPECT_TRUE(test::has(refusal(), "is a link"));
  EXPECT_THROW(write_state_file(file().string(), "ours"), std::runtime_error);
  EXPECT_EQ(content("victim"), "secret");
  fs::remove(file());
  fs::create_hard_link(victim(), file());
  EXPECT_TRUE(test::has(refusal(), "other names"));
  write_state_file(file().string(), "ours");
  EXPECT_EQ(content("victim"), "secret");
  EXPECT_EQ(content("state/nose.model.toml"), "ours");
  fs::remove(file());
  ASSERT_EQ(::mkfifo(file().c_str(), 0600), 0);
  EXPECT_TRUE(test::has(refusal(), "no regular file"));
}

}  // namespace
}  // namespace ifog

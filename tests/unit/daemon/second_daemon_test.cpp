// SPDX-License-Identifier: Apache-2.0
// Two daemons at one thing: the second is refused before it has touched anything.
#include <sys/file.h>

#include "tests/unit/daemon/running_daemon.h"

namespace ifog {
namespace {

class SecondDaemon : public RunningDaemon {
 protected:
  // Exit status of another daemon; what it says goes to `second`.
  int run_second(const std::string& configuration) const { return ifogd("", configuration, "second"); }
  std::string second_said() const { return content("second"); }
};

TEST_F(SecondDaemon, OneFifoIsOneDaemons) {
  write("ifogd.toml", kDaemon + sensor("nose"));
  write("other.toml", kDaemon + sensor("nose") + sensor("tail"));
  start();
  send("nose", 100);
  ASSERT_TRUE(await([&] { return listener_->last["IFOG_NOSE_STATUS"].samples_published == 100; })) << said();
  EXPECT_EQ(run_second("other.toml"), 1);
  EXPECT_EQ(second_said(), "ifogd: " + path("nose") +
                               ": another process reads it: Device or resource busy, expected a device or "
                               "FIFO of this daemon's own\n");
  send("nose", 100);
  EXPECT_TRUE(await([&] { return listener_->last["IFOG_NOSE_STATUS"].samples_published == 200; })) << said();
  EXPECT_EQ(end(), 0) << said();
  // With the first one's end, however that came, the FIFO is free.
  start();
  ASSERT_TRUE(await([&] { return times_said("nose: reading") >= 1; })) << said();
  kill(child_, SIGKILL);
  waitpid(child_, nullptr, 0);
  start();
  send("nose", 100);
  EXPECT_TRUE(await([&] { return listener_->last["IFOG_NOSE_STATUS"].samples_published == 100; })) << said();
  EXPECT_EQ(end(), 0) << said();
}

TEST_F(SecondDaemon, OneStateFolderIsOneDaemons) {
  const std::string daemon = std::string(kDaemon) + "state_folder = \"state\"\n";
  write("ifogd.toml", daemon + sensor("nose"));
  write("other.toml", daemon + sensor("tail"));
  start();
  ASSERT_TRUE(await([&] { return listener_->heard["IFOG_NOSE_STATUS"] >= 1; })) << said();
  EXPECT_EQ(run_second("other.toml"), 1);
  EXPECT_EQ(second_said(), "ifogd: " + path("state/ifogd.lock") + ": another daemon, process " +
                               std::to_string(child_) +
                               ", works with this state folder; expected one of its own for each\n");
  EXPECT_EQ(listener_->heard["IFOG_TAIL_STATUS"], 0);
  EXPECT_EQ(end(), 0) << said();
}

// A capture may be read by many; its channel is one daemon's.
TEST_F(SecondDaemon, WhoPublishesOnATakenChannelSaysSo) {
  write("ifogd.toml", kDaemon + sensor("nose"));
  start();
  ASSERT_TRUE(await([&] { return listener_->heard["IFOG_NOSE_STATUS"] >= 1; })) << said();
  EXPECT_EQ(times_said("another daemon publishes"), 0);
  write("capture.csv", "time_s,rate_radps\n0,0.1\n0.01,0.1\n0.02,0.1\n");
  for (const std::string name : {"nose", "tail"}) {
    write("other.toml", std::string(kDaemon) + "[[sensor]]\nname = \"" + name +
                            "\"\ndriver = \"capture\"\n[sensor.options]\nrate_hz = 100\n" +
                            "[sensor.transport]\ntype = \"file\"\npath = \"capture.csv\"\n");
    run_second("other.toml");
    EXPECT_EQ(
        second_said().find("another daemon publishes on IFOG_NOSE of this lcm_url") != std::string::npos,
        name == "nose")
        << second_said();
  }
  EXPECT_EQ(end(), 0) << said();
}

TEST_F(SecondDaemon, AFolderOfRecordingsIsOneRecorders) {
  write("ifogd.toml", kDaemon + sensor("nose") + "[sensor.record]\nfolder = \"rec\"\n");
  const std::string record = "timeout 60 " IFOG_BINARY_DIR "/tools/ifog/ifog record --seconds 1 --output " +
                             path("rec/nose") + " >" + path("second") + " 2>&1";
  // The daemon's own.
  start();
  send("nose", 100);
  ASSERT_TRUE(await([&] { return listener_->last["IFOG_NOSE_STATUS"].record_file_bytes > 0; })) << said();
  EXPECT_EQ(WEXITSTATUS(std::system(record.c_str())), 1);
  EXPECT_EQ(second_said(), "ifog: " + path("rec/nose") +
                               ": another recorder writes into it (expected a folder of its own)\n");
  EXPECT_EQ(end(), 0) << said();
  EXPECT_EQ(std::distance(fs::directory_iterator(path("rec/nose")), fs::directory_iterator()), 1);
  // And one that the daemon finds taken: it continues without it, and says so.
  const int held = open(path("rec/nose").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(flock(held, LOCK_EX | LOCK_NB), 0);
  start();
  send("nose", 100);
  EXPECT_TRUE(await([&] { return listener_->last["IFOG_NOSE_STATUS"].samples_published == 100; })) << said();
  EXPECT_TRUE(await([&] {
    return times_said("recorder: " + path("rec/nose") +
                      ": another recorder writes into it (expected a folder of its own)") == 1;
  })) << said();
  close(held);
  EXPECT_TRUE(await([&] { return times_said("all is recorded again, nothing is lost") == 1; })) << said();
  EXPECT_EQ(end(), 0) << said();
}

// The folder need not be there; who checks is told where it could not be made, and nothing is.
TEST_F(SecondDaemon, AStateFolderThatCannotBeMadeIsSaidByTheCheck) {
  write("file", "");
  write("ifogd.toml", std::string(kDaemon) + "state_folder = \"file/state\"\n" + sensor("nose"));
  EXPECT_EQ(ifogd("--check"), 0) << said();
  EXPECT_EQ(times_said("daemon.state_folder = \"" + path("file/state") +
                       "\": cannot be made: Not a directory, expected a folder that the daemon may write"),
            1)
      << said();
  write("ifogd.toml", std::string(kDaemon) + "state_folder = \"new/state\"\n" + sensor("nose"));
  EXPECT_EQ(ifogd("--check"), 0) << said();
  EXPECT_EQ(times_said("state_folder"), 0) << said();
  EXPECT_FALSE(fs::exists(path("new")));
}

}  // namespace
}  // namespace ifog

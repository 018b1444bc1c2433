// SPDX-License-Identifier: Apache-2.0
// The daemon while it runs: what reloading, silence and a lost log do to it.
#include <sys/file.h>

#include "tests/unit/daemon/running_daemon.h"
#include "tests/unit/messages.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

TEST_F(RunningDaemon, AReloadTakesEffectForAllSensorsOrForNone) {
  write("ifogd.toml", kDaemon + sensor("nose") + sensor("tail"));
  start();
  send("nose", 10);
  send("tail", 10);
  ASSERT_TRUE(published(10)) << said();
  // The nose's model is good, the tail's is not: before, the nose had its own and the log named no sensor.
  write("good.toml", kModel);
  write("bad.toml",
        std::string(kModel) + "[[range]]\nchannel = \"temperature_degC\"\nlow = 2.0\nhigh = 1.0\n");
  write("ifogd.toml",
        kDaemon + sensor("nose", "model = \"good.toml\"\n") + sensor("tail", "model = \"bad.toml\"\n"));
  kill(child_, SIGHUP);
  ASSERT_TRUE(says("reload refused: nothing has changed for any sensor", 1)) << said();
  EXPECT_EQ(times_said("sensor \"tail\": " + path("bad.toml") + ":6: range[1].high"), 1) << said();
  send("nose", 10);
  ASSERT_TRUE(published(20)) << said();
  EXPECT_EQ(nose().model, "");
  EXPECT_EQ(nose().filter_resets, 0);
  write("ifogd.toml", kDaemon + sensor("nose") + sensor("tail", "options.rate_hzz = 100\n"));
  kill(child_, SIGHUP);
  ASSERT_TRUE(says("reload refused: nothing has changed for any sensor", 2)) << said();
  // Now both; and what a reload cannot do is said.
  write("bad.toml", kModel);
  write("ifogd.toml", std::string(kDaemon) + "log_level = \"debug\"\n" +
                          sensor("nose", "model = \"good.toml\"\nrange_radps = 5.0\n") + sensor("belly"));
  kill(child_, SIGHUP);
  ASSERT_TRUE(says("nose: reloaded: model " + path("good.toml"))) << said();
  EXPECT_EQ(times_said("nose: changed, needs a restart: range_radps"), 1) << said();
  EXPECT_EQ(times_said("changed in [daemon], needs a restart: log_level"), 1) << said();
  EXPECT_EQ(times_said("sensor \"belly\" is new"), 1) << said();
  EXPECT_EQ(times_said("tail: no longer in"), 1) << said();
  send("nose", 10);
  EXPECT_TRUE(await([&] { return nose().model.size() == 12; })) << said();
  EXPECT_EQ(end(), 0) << said();
}

TEST_F(RunningDaemon, AFloodOfReloadsIsOneASecondAndTheStatusGoesOn) {
  write("ifogd.toml", kDaemon + sensor("nose"));
  start();
  ASSERT_TRUE(seconds(1)) << said();
  const int before = listener_->heard["IFOG_NOSE_STATUS"];
  ASSERT_TRUE(await([&] {
    for (int n = 0; n < 5; ++n) {
      kill(child_, SIGHUP);
      std::this_thread::sleep_for(2ms);
    }
    return listener_->heard["IFOG_NOSE_STATUS"] - before >= 3;
  })) << said();
  const int reloads = times_said("nose: reloaded");
  EXPECT_GE(reloads, 1);
  // As many as seconds have gone by, and a status message is sent in each.
  EXPECT_LE(reloads, listener_->heard["IFOG_NOSE_STATUS"] - before + 3) << said();
  EXPECT_EQ(end(), 0);
}

TEST_F(RunningDaemon, AFifoThatFallsSilentHasNoData) {
  write("ifogd.toml", kDaemon + sensor("nose"));
  start();
  send("nose", 100);
  ASSERT_TRUE(comes_to(status_t::STATE_RUNNING)) << said();
  EXPECT_TRUE(comes_to(status_t::STATE_NO_DATA)) << said();
  send("nose", 100);
  EXPECT_TRUE(comes_to(status_t::STATE_RUNNING)) << said();
  EXPECT_EQ(end(), 0);
}

// Judged by its own rate: between two samples of a slow sensor nothing is amiss.
TEST_F(RunningDaemon, ASlowSensorIsNotWithoutData) {
  write("ifogd.toml", kDaemon + sensor("nose", "nominal_rate_hz = 0.1\n"));
  start();
  send("nose", 1);
  ASSERT_TRUE(comes_to(status_t::STATE_RUNNING)) << said();
  ASSERT_TRUE(seconds(4)) << said();
  EXPECT_EQ(nose().state, status_t::STATE_RUNNING);
  EXPECT_EQ(times_said("no data"), 0) << said();
  EXPECT_EQ(end(), 0);
}

TEST_F(RunningDaemon, ALogThatNobodyReadsOrThatIsClosedEndsNothing) {
  // A pipe without a reader: SIGPIPE at the first line.
  ASSERT_EQ(mkfifo(path("said").c_str(), 0600), 0);
  const int reader = open(path("said").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  write("ifogd.toml", kDaemon + sensor("nose"));
  start();
  ASSERT_TRUE(seconds(1));
  close(reader);
  kill(child_, SIGHUP);  // which has something to say
  EXPECT_TRUE(seconds(2));
  EXPECT_EQ(end(), 0);
  // Closed from the start: whatever is opened next must not get its number, and the log.
  write("ifogd.toml", kDaemon + sensor("tail"));
  start(nullptr);
  const int first = listener_->heard["IFOG_TAIL_STATUS"];
  ASSERT_TRUE(await([&] { return listener_->heard["IFOG_TAIL_STATUS"] > first; }));
  EXPECT_EQ(fs::read_symlink("/proc/" + std::to_string(child_) + "/fd/2"), "/dev/null");
  EXPECT_EQ(end(), 0);
}

TEST_F(RunningDaemon, ChannelsFromAFileAndFromLcmReachTheSensor) {
  write("hwmon", "41250\n");
  write("ifogd.toml",
        kDaemon + sensor("nose") +
            "[[sensor.channel]]\nname = \"coil_degC\"\nsource = \"file\"\npath = \"hwmon\"\nscale = 1e-3\n"
            "period_s = 0.1\n"
            "[[sensor.channel]]\nname = \"hull_degC\"\nsource = \"lcm\"\nlcm_channel = \"HULL\"\n"
            "[[sensor.channel]]\nname = \"load_us\"\nsource = \"lcm\"\nlcm_channel = \"IFOG_NOSE_STATUS\"\n"
            "field = \"input_rate_hz\"\n");
  start();
  const auto value = [&](const char* channel) { return listener_->channel("IFOG_NOSE_STATUS", channel); };
  EXPECT_TRUE(await([&] {
    send("nose", 5);
    listener_->send("HULL", encoded(channel("hull_degC", 18.5)));
    return value("coil_degC") == 41.25 && value("hull_degC") == 18.5 && value("load_us") > 0.0;
  })) << said();
  EXPECT_EQ(end(), 0) << said();
}

TEST_F(RunningDaemon, WhatIsNotThereIsSaidByTheCheck) {
  write("ifogd.toml",
        kDaemon + sensor("nose") +
            "[[sensor.channel]]\nname = \"coil_degC\"\nsource = \"file\"\npath = \"nothing\"\n");
  EXPECT_EQ(ifogd("--check"), 0) << said();
  EXPECT_EQ(times_said("nose: channel 'coil_degC': " + path("nothing") +
                       ": cannot read: No such file or directory, expected a file that holds one number"),
            1)
      << said();
  // A FIFO in the model's place was waited for.
  ASSERT_EQ(mkfifo(path("model").c_str(), 0600), 0);
  write("ifogd.toml", kDaemon + sensor("nose", "model = \"model\"\n"));
  EXPECT_EQ(ifogd("--check"), 2) << said();
  EXPECT_EQ(times_said(path("model") + ": is no regular file"), 1) << said();
}

// What one run has learned of the noise the next one begins with; what cannot be read is learned again, and
// where the settings say it nothing is kept.
TEST_F(RunningDaemon, NoiseIsKeptOverRestartsWithItsDate) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> noise(0.01, 1e-3);
  const std::vector<std::uint8_t> bytes = kvh_frames(0, 20'000, [&](int) { return noise(engine); });
  write("frames", {bytes.begin(), bytes.end()});
  const std::string config =
      "[daemon]\nlock_memory = false\nstate_folder = \"state\"\n[[sensor]]\nname = \"nose\"\ndriver = "
      "\"kvh1750\"\nnominal_rate_hz = 1000\n[sensor.transport]\ntype = \"file\"\npath = \"frames\"\n";
  fs::create_directories(path("state"));
  const auto run_to_the_end = [&](const std::string& more) {
    write("ifogd.toml", config + more);
    return ifogd();
  };
  const auto kept = [&] { return content("state/nose.noise.toml"); };
  const auto samples = [&] {
    const std::string text = kept();
    return std::strtod(text.c_str() + text.find("\nsamples = ") + 11, nullptr);
  };
  ASSERT_EQ(run_to_the_end(""), 0) << said();
  EXPECT_EQ(times_said("noise learned at rest"), 1) << said();
  EXPECT_EQ(times_said("noise as learned until"), 0) << said();
  const double first = samples();
  EXPECT_GE(first, 4096.0) << kept();
  EXPECT_TRUE(test::has(kept(), "learned = \"20"));

  ASSERT_EQ(run_to_the_end(""), 0) << said();
  EXPECT_EQ(times_said("noise from start-up data"), 0) << said();
  EXPECT_EQ(times_said("noise as learned until 20"), 1) << said();
  EXPECT_GT(samples(), first) << "learned on";

  const std::string before = kept();
  ASSERT_EQ(run_to_the_end("[sensor.filter]\nprocess_noise = 1e-10\nmeasurement_noise = 1e-8\n"), 0)
      << said();
  EXPECT_EQ(kept(), before) << "what is told is not learned over";

  write("state/nose.noise.toml", before.substr(0, before.size() / 2));
  ASSERT_EQ(run_to_the_end(""), 0) << said();
  EXPECT_EQ(times_said("learned again"), 1) << said();
  EXPECT_EQ(samples(), first) << kept();

  // A folder that is not there is made; where none can be, it is said once.
  fs::remove_all(path("state"));
  ASSERT_EQ(run_to_the_end(""), 0) << said();
  EXPECT_GE(samples(), 4096.0) << said();
  EXPECT_EQ(fs::status(path("state")).permissions(), fs::perms(02775));
  fs::remove_all(path("state"));
  write("state", "");
  ASSERT_EQ(run_to_the_end(""), 0) << said();
  EXPECT_EQ(times_said("daemon.state_folder = \"" + path("state") + "\": cannot be made"), 1) << said();
  EXPECT_EQ(times_said("learned noise is not kept"), 1) << said();
}

// Two daemons at one thing: the second is refused before it has touched anything.

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
  ASSERT_TRUE(published(100)) << said();
  EXPECT_EQ(run_second("other.toml"), 1);
  EXPECT_EQ(second_said(), "ifogd: " + path("nose") +
                               ": another process reads it: Device or resource busy, expected a device or "
                               "FIFO of this daemon's own\n");
  send("nose", 100);
  EXPECT_TRUE(published(200)) << said();
  EXPECT_EQ(end(), 0) << said();
  // With the first one's end, however that came, the FIFO is free.
  start();
  ASSERT_TRUE(await([&] { return times_said("nose: reading") >= 1; })) << said();
  kill(child_, SIGKILL);
  waitpid(child_, nullptr, 0);
  start();
  send("nose", 100);
  EXPECT_TRUE(published(100)) << said();
  EXPECT_EQ(end(), 0) << said();
}

TEST_F(SecondDaemon, OneStateFolderIsOneDaemons) {
  const std::string daemon = std::string(kDaemon) + "state_folder = \"state\"\n";
  write("ifogd.toml", daemon + sensor("nose"));
  write("other.toml", daemon + sensor("tail"));
  start();
  ASSERT_TRUE(seconds(1)) << said();
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
  ASSERT_TRUE(seconds(1)) << said();
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
  ASSERT_TRUE(await([&] { return nose().record_file_bytes > 0; })) << said();
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
  EXPECT_TRUE(published(100)) << said();
  EXPECT_TRUE(says("recorder: " + path("rec/nose") +
                   ": another recorder writes into it (expected a folder of its own)"))
      << said();
  close(held);
  EXPECT_TRUE(says("all is recorded again, nothing is lost")) << said();
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

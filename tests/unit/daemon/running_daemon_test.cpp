// SPDX-License-Identifier: Apache-2.0
// The daemon while it runs: what reloading, silence and a lost log do to it.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <ifog/decode.h>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "drivers/host/driver_instance.h"
#include "tests/unit/daemon/private_network.h"

namespace ifog {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

// What all sensors publish, the latest of each.
class Listener {
 public:
  Listener() : lcm_(lcm_create("udpm://239.255.76.67:7667?ttl=0")) {
    lcm_subscribe(
        lcm_, "IFOG_.*_STATUS",
        [](const lcm_recv_buf_t* buffer, const char* channel, void* user) {
          auto* self = static_cast<Listener*>(user);
          ASSERT_TRUE(decode_message(buffer->data, buffer->data_size, self->last[channel]));
          ++self->heard[channel];
        },
        this);
  }
  ~Listener() { lcm_destroy(lcm_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  void listen(int milliseconds) {
    pollfd wanted{lcm_get_fileno(lcm_), POLLIN, 0};
    if (poll(&wanted, 1, milliseconds) > 0) lcm_handle(lcm_);
  }
  std::map<std::string, status_t> last;
  std::map<std::string, int> heard;

 private:
  lcm_t* lcm_;
};

class RunningDaemon : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("running-daemon-" + std::to_string(getpid()));
    fs::create_directories(folder_);
    if (const std::string why = enter_private_network(); !why.empty())
      GTEST_SKIP() << "no private network namespace (" << why << "); runs as root or with user namespaces";
    listener_ = std::make_unique<Listener>();
  }
  void TearDown() override {
    if (child_ > 0) kill(child_, SIGKILL);
    if (child_ > 0) waitpid(child_, nullptr, 0);
    for (const auto& [name, fifo] : fifos_) close(fifo);
    fs::remove_all(folder_);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  std::string said() const {
    std::ifstream in(path("said"));
    return {std::istreambuf_iterator<char>(in), {}};
  }
  int times_said(const std::string& text) const {
    const std::string all = said();
    int count = 0;
    for (std::size_t at = all.find(text); at != std::string::npos; at = all.find(text, at + 1)) ++count;
    return count;
  }
  // A sensor that reads a FIFO, whose writing end this test holds.
  std::string sensor(const std::string& name, const std::string& more = "") {
    if (!fs::exists(path(name))) {
      EXPECT_EQ(mkfifo(path(name).c_str(), 0600), 0);
      fifos_[name] = open(path(name).c_str(), O_RDWR | O_CLOEXEC);
    }
    return "[[sensor]]\nname = \"" + name + "\"\ndriver = \"kvh1750\"\n" + more +
           "[sensor.transport]\ntype = \"file\"\npath = \"" + name +
           "\"\n[sensor.filter]\n"
           "process_noise = 1e-10\nmeasurement_noise = 1e-8\n";
  }
  void start(const char* stderr_to = "said") {
    child_ = fork();
    ASSERT_GE(child_, 0);
    if (child_ != 0) return;
    close(STDERR_FILENO);
    if (stderr_to != nullptr) open(path(stderr_to).c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    execl(IFOG_BINARY_DIR "/daemon/ifogd", "ifogd", "--config", path("ifogd.toml").c_str(), nullptr);
    _exit(127);
  }
  // Generous: only a test that fails waits so long.
  template <typename Condition>
  bool await(Condition&& condition) {
    for (int n = 0; n < 600; ++n) {
      if (condition()) return true;
      listener_->listen(50);
    }
    return false;
  }
  void send(const std::string& sensor, int count) {
    std::vector<std::uint8_t> bytes;
    for (int n = 0; n < count; ++n) {
      ifog_sample sample{};
      sample.flags = IFOG_SAMPLE_SEQUENCE;
      sample.sequence = sent_[sensor]++ % 128;
      sample.valid_axes = 7;
      for (double& value : sample.value) value = 0.01;
      encoder_.encode_bytes(sample, bytes);
    }
    ASSERT_EQ(::write(fifos_[sensor], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  int end() {
    kill(child_, SIGTERM);
    int status = 0;
    waitpid(std::exchange(child_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }

  fs::path folder_;
  std::unique_ptr<Listener> listener_;
  std::map<std::string, int> fifos_;
  pid_t child_ = -1;
  std::map<std::string, std::uint32_t> sent_;
  DriverInstance encoder_ = make_driver("kvh1750", {{"format", "a"}});
};

constexpr const char* kDaemon = "[daemon]\nlock_memory = false\n";
constexpr const char* kModel = "version = 1\nsensor = \"made\"\n";

TEST_F(RunningDaemon, AReloadTakesEffectForAllSensorsOrForNone) {
  write("ifogd.toml", kDaemon + sensor("nose") + sensor("tail"));
  start();
  send("nose", 10);
  send("tail", 10);
  ASSERT_TRUE(await([&] { return listener_->last["IFOG_NOSE_STATUS"].samples_published == 10; })) << said();
  // The nose's model is good, the tail's is not: before, the nose had its own and the log named no sensor.
  write("good.toml", kModel);
  write("bad.toml",
        std::string(kModel) + "[[range]]\nchannel = \"temperature_degC\"\nlow = 2.0\nhigh = 1.0\n");
  write("ifogd.toml",
        kDaemon + sensor("nose", "model = \"good.toml\"\n") + sensor("tail", "model = \"bad.toml\"\n"));
  kill(child_, SIGHUP);
  ASSERT_TRUE(await([&] { return times_said("reload refused: nothing has changed for any sensor") == 1; }))
      << said();
  EXPECT_EQ(times_said("sensor \"tail\": " + path("bad.toml") + ":6: range[1].high"), 1) << said();
  send("nose", 10);
  ASSERT_TRUE(await([&] { return listener_->last["IFOG_NOSE_STATUS"].samples_published == 20; })) << said();
  EXPECT_EQ(listener_->last["IFOG_NOSE_STATUS"].model, "");
  EXPECT_EQ(listener_->last["IFOG_NOSE_STATUS"].filter_resets, 0);
  // Now both; and what a reload cannot do is said.
  write("bad.toml", kModel);
  write("ifogd.toml", std::string(kDaemon) + "log_level = \"debug\"\n" +
                          sensor("nose", "model = \"good.toml\"\nrange_radps = 5.0\n") + sensor("belly"));
  kill(child_, SIGHUP);
  ASSERT_TRUE(await([&] { return times_said("nose: reloaded: model " + path("good.toml")) == 1; })) << said();
  EXPECT_EQ(times_said("nose: changed, needs a restart: range_radps"), 1) << said();
  EXPECT_EQ(times_said("changed in [daemon], needs a restart: log_level"), 1) << said();
  EXPECT_EQ(times_said("sensor \"belly\" is new"), 1) << said();
  EXPECT_EQ(times_said("tail: no longer in"), 1) << said();
  send("nose", 10);
  EXPECT_TRUE(await([&] { return listener_->last["IFOG_NOSE_STATUS"].model.size() == 12; })) << said();
  EXPECT_EQ(end(), 0) << said();
}

TEST_F(RunningDaemon, AFloodOfReloadsIsOneASecondAndTheStatusGoesOn) {
  write("ifogd.toml", kDaemon + sensor("nose"));
  start();
  ASSERT_TRUE(await([&] { return listener_->heard["IFOG_NOSE_STATUS"] >= 1; })) << said();
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
  ASSERT_TRUE(await([&] { return listener_->last["IFOG_NOSE_STATUS"].state == status_t::STATE_RUNNING; }))
      << said();
  EXPECT_TRUE(await([&] { return listener_->last["IFOG_NOSE_STATUS"].state == status_t::STATE_NO_DATA; }))
      << said();
  send("nose", 100);
  EXPECT_TRUE(await([&] { return listener_->last["IFOG_NOSE_STATUS"].state == status_t::STATE_RUNNING; }))
      << said();
  EXPECT_EQ(end(), 0);
}

TEST_F(RunningDaemon, ALogThatNobodyReadsOrThatIsClosedEndsNothing) {
  // A pipe without a reader: SIGPIPE at the first line.
  ASSERT_EQ(mkfifo(path("said").c_str(), 0600), 0);
  const int reader = open(path("said").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  write("ifogd.toml", kDaemon + sensor("nose"));
  start();
  ASSERT_TRUE(await([&] { return listener_->heard["IFOG_NOSE_STATUS"] >= 1; }));
  close(reader);
  kill(child_, SIGHUP);  // which has something to say
  const int before = listener_->heard["IFOG_NOSE_STATUS"];
  EXPECT_TRUE(await([&] { return listener_->heard["IFOG_NOSE_STATUS"] >= before + 2; }));
  EXPECT_EQ(end(), 0);
  // Closed from the start: whatever is opened next must not get its number, and the log.
  write("ifogd.toml", kDaemon + sensor("tail"));
  start(nullptr);
  const int first = listener_->heard["IFOG_TAIL_STATUS"];
  ASSERT_TRUE(await([&] { return listener_->heard["IFOG_TAIL_STATUS"] > first; }));
  EXPECT_EQ(fs::read_symlink("/proc/" + std::to_string(child_) + "/fd/2"), "/dev/null");
  EXPECT_EQ(end(), 0);
}

// kB that the daemon holds locked with so many sensors; 0 where it may not lock any.
TEST_F(RunningDaemon, ASensorHoldsFewMegabytesOfLockedMemory) {
  const auto locked_kB = [&](int sensors) {
    std::string config = "[daemon]\nlock_memory = true\n";
    for (int n = 0; n < sensors; ++n) config += sensor("s" + std::to_string(n));
    write("ifogd.toml", config);
    const std::string last = "IFOG_S" + std::to_string(sensors - 1) + "_STATUS";
    const int before = listener_->heard[last];
    start();
    EXPECT_TRUE(await([&] { return listener_->heard[last] > before; })) << said();
    std::ifstream status("/proc/" + std::to_string(child_) + "/status");
    long kB = 0;
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("VmLck:")) kB = std::stol(line.substr(6));
    EXPECT_EQ(end(), 0);
    return kB;
  };
  const long one = locked_kB(1);
  if (one == 0) GTEST_SKIP() << "may not lock memory: " << said();
  EXPECT_LT((locked_kB(9) - one) / 8, 4096);
}

TEST_F(RunningDaemon, WhatIsNotThereIsSaidByTheCheck) {
  write("ifogd.toml",
        kDaemon + sensor("nose") +
            "[[sensor.channel]]\nname = \"coil_degC\"\nsource = \"file\"\npath = \"nothing\"\n");
  const std::string command = "timeout 60 " IFOG_BINARY_DIR "/daemon/ifogd --check --config " +
                              path("ifogd.toml") + " >" + path("said") + " 2>&1";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 0) << said();
  EXPECT_EQ(times_said("nose: channel 'coil_degC': " + path("nothing") +
                       ": cannot read: No such file or directory, expected a file that holds one number"),
            1)
      << said();
  // A FIFO in the model's place was waited for.
  ASSERT_EQ(mkfifo(path("model").c_str(), 0600), 0);
  write("ifogd.toml", kDaemon + sensor("nose", "model = \"model\"\n"));
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2) << said();
  EXPECT_EQ(times_said(path("model") + ": is no regular file"), 1) << said();
}

// What one run has learned of the noise the next one begins with; what cannot be read is learned anew, and
// where the settings say it nothing is kept.
TEST_F(RunningDaemon, NoiseIsKeptOverRestartsWithItsDate) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> noise(0.01, 1e-3);
  std::vector<std::uint8_t> bytes;
  for (int n = 0; n < 20'000; ++n) {
    ifog_sample sample{};
    sample.flags = IFOG_SAMPLE_SEQUENCE;
    sample.sequence = static_cast<std::uint32_t>(n % 128);
    sample.valid_axes = 7;
    for (double& value : sample.value) value = noise(engine);
    encoder_.encode_bytes(sample, bytes);
  }
  std::ofstream(path("frames"), std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const std::string config =
      "[daemon]\nlock_memory = false\nstate_folder = \"state\"\n[[sensor]]\nname = \"nose\"\ndriver = "
      "\"kvh1750\"\nnominal_rate_hz = 1000\n[sensor.transport]\ntype = \"file\"\npath = \"frames\"\n";
  fs::create_directories(folder_ / "state");
  const auto run_to_the_end = [&](const std::string& more) {
    write("ifogd.toml", config + more);
    fs::remove(folder_ / "said");
    start();
    int status = 0;
    waitpid(std::exchange(child_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  };
  const auto kept = [&] {
    std::ifstream in(path("state/nose.noise.toml"));
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const auto samples = [&] {
    const std::string text = kept();
    return std::strtod(text.c_str() + text.find("\nsamples = ") + 11, nullptr);
  };
  ASSERT_EQ(run_to_the_end(""), 0) << said();
  EXPECT_EQ(times_said("noise from start-up data"), 1) << said();
  EXPECT_EQ(times_said("noise as learned until"), 0) << said();
  const double first = samples();
  EXPECT_GE(first, 4096.0) << kept();
  EXPECT_NE(kept().find("learned = \"20"), std::string::npos) << kept();

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
  EXPECT_EQ(times_said("learned anew"), 1) << said();
  EXPECT_EQ(samples(), first) << kept();

  fs::remove_all(folder_ / "state");
  ASSERT_EQ(run_to_the_end(""), 0) << said();
  EXPECT_EQ(times_said("learned noise is not kept"), 1) << said();
}

}  // namespace
}  // namespace ifog

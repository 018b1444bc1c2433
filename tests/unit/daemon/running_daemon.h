// SPDX-License-Identifier: Apache-2.0
// A daemon that runs while a test writes into its FIFOs and listens to what it publishes, in a folder and a
// network of its own.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <ifog/decode.h>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/host/driver_instance.h"
#include "tests/unit/daemon/private_network.h"

namespace ifog {

namespace fs = std::filesystem;

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

inline constexpr const char* kDaemon = "[daemon]\nlock_memory = false\n";
inline constexpr const char* kModel = "version = 1\nsensor = \"made\"\n";

}  // namespace ifog

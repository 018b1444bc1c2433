// SPDX-License-Identifier: Apache-2.0
// A daemon that runs while a test writes into its FIFOs and listens to what it publishes, in a folder and a
// network of its own.
#pragma once

#include <ifog/decode.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <sys/stat.h>

#include "tests/unit/daemon/daemon_process.h"
#include "tests/unit/daemon/kvh_frames.h"
#include "tests/unit/test.h"

namespace ifog {

// What sensors publish: the latest status of each, and every sample of the sensor "nose".
class Listener {
 public:
  Listener() : lcm_(lcm_create(kUrl)) {
    lcm_subscription_t* const samples = lcm_subscribe(
        lcm_, "IFOG_NOSE",
        [](const lcm_recv_buf_t* buffer, const char*, void* user) {
          auto* const self = static_cast<Listener*>(user);
          ASSERT_TRUE(decode_message(buffer->data, buffer->data_size, self->rates.emplace_back()));
        },
        this);
    lcm_subscription_set_queue_capacity(samples, 100'000);
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
    while (poll(&wanted, 1, milliseconds) > 0 && lcm_handle(lcm_) == 0) milliseconds = 0;
  }
  // The latest value of a sensor's channel; NaN before the first.
  double channel(const std::string& sensor, const std::string& name) {
    const status_t& status = last[sensor];
    const auto found = std::find(status.channel_name.begin(), status.channel_name.end(), name);
    return found == status.channel_name.end()
               ? NAN
               : status.channel_value[static_cast<std::size_t>(found - status.channel_name.begin())];
  }
  void send(const char* channel, const std::vector<std::uint8_t>& message) {
    lcm_publish(lcm_, channel, message.data(), static_cast<unsigned>(message.size()));
  }
  std::vector<rate_t> rates;
  std::map<std::string, status_t> last;
  std::map<std::string, int> heard;

 private:
  lcm_t* lcm_;
};

class RunningDaemon : public DaemonProcess {
 protected:
  void SetUp() override {
    DaemonProcess::SetUp();
    if (!IsSkipped()) listener_ = std::make_unique<Listener>();
  }
  void TearDown() override {
    DaemonProcess::TearDown();
    for (const auto& [name, fifo] : fifos_) close(fifo);
  }
  // The writing end of the FIFO of that name.
  int fifo(const std::string& name) {
    if (fifos_.contains(name)) return fifos_[name];
    EXPECT_EQ(mkfifo(path(name).c_str(), 0600), 0);
    return fifos_[name] = open(path(name).c_str(), O_RDWR | O_CLOEXEC);
  }
  // A sensor that reads a FIFO, whose writing end this test holds.
  std::string sensor(const std::string& name, const std::string& more = "") {
    (void)fifo(name);
    return "[[sensor]]\nname = \"" + name + "\"\ndriver = \"kvh1750\"\n" + more +
           "[sensor.transport]\ntype = \"file\"\npath = \"" + name +
           "\"\n[sensor.filter]\n"
           "process_noise = 1e-10\nmeasurement_noise = 1e-8\n";
  }
  // Generous: only a test that fails waits so long.
  template <typename Condition>
  bool await(Condition&& condition) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (std::chrono::steady_clock::now() < until) {
      if (condition()) return true;
      listener_->listen(50);
    }
    return false;
  }
  // Of the sensor "nose": its last status, and whether one comes with so many samples published, or of that state.
  const status_t& nose() { return listener_->last["IFOG_NOSE_STATUS"]; }
  bool published(std::int64_t samples) {
    return await([&] { return nose().samples_published == samples; });
  }
  bool comes_to(std::int32_t state) {
    return await([&] { return nose().state == state; });
  }
  // So many status messages more.
  bool seconds(int count) {
    const int before = listener_->heard["IFOG_NOSE_STATUS"];
    return await([&] { return listener_->heard["IFOG_NOSE_STATUS"] >= before + count; });
  }
  bool says(const std::string& text, int times = 1) {
    return await([&] { return times_said(text) == times; });
  }
  void send(const std::string& sensor, int count) {
    const std::vector<std::uint8_t> bytes = kvh_frames(sent_[sensor], count, [](int) { return 0.01; });
    sent_[sensor] += count;
    ASSERT_EQ(::write(fifos_[sensor], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }

  std::unique_ptr<Listener> listener_;
  std::map<std::string, int> fifos_;
  std::map<std::string, int> sent_;
};

inline constexpr const char* kDaemon = "[daemon]\nlock_memory = false\n";
inline constexpr const char* kModel = "version = 1\nsensor = \"made\"\n";

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// Records messages into an LCM log, as lcm-logger does, without losses: lcm-logger 1.3.1 has a queue of 30
// messages, so it loses some if its thread waits longer than they last (20 ms at 1.5 kHz). This queue has no
// limit.
//
// usage: lcm_record URL CHANNEL LOG      ends with SIGTERM or SIGINT and prints the number of messages
#include <csignal>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <string>

namespace {

volatile std::sig_atomic_t stop = 0;

class Recorder {
 public:
  explicit Recorder(const std::string& path) : log_(path, "w") {}
  [[nodiscard]] bool good() { return log_.good(); }
  [[nodiscard]] long long written() const { return number_; }
  [[nodiscard]] bool failed() const { return failed_; }

  void received(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    lcm::LogEvent event;
    event.eventnum = number_++;
    event.timestamp = buffer->recv_utime;
    event.channel = channel;
    event.datalen = static_cast<std::int32_t>(buffer->data_size);
    event.data = buffer->data;
    failed_ = failed_ || log_.writeEvent(&event) != 0;
  }

 private:
  lcm::LogFile log_;
  long long number_ = 0;
  bool failed_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: lcm_record URL CHANNEL LOG\n");
    return 2;
  }
  lcm::LCM lcm(argv[1]);
  Recorder recorder(argv[3]);
  if (!lcm.good() || !recorder.good()) {
    std::fprintf(stderr, "lcm_record: %s cannot be opened\n", lcm.good() ? argv[3] : argv[1]);
    return 1;
  }
  lcm.subscribe(argv[2], &Recorder::received, &recorder)->setQueueCapacity(0);
  std::signal(SIGTERM, [](int) { stop = 1; });
  std::signal(SIGINT, [](int) { stop = 1; });
  std::printf("recording\n");
  std::fflush(stdout);
  while (stop == 0) lcm.handleTimeout(100);
  while (lcm.handleTimeout(100) > 0) {
  }
  std::printf("%lld messages\n", recorder.written());
  return recorder.failed() ? 1 : 0;
}

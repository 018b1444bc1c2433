// SPDX-License-Identifier: Apache-2.0
// A subscriber like an INS: counts messages on IFOG_<NAME> channels and checks their sequence.  usage:
// lcm_count SECONDS CHANNEL...
//
// Prints one JSON object at the end, or on SIGTERM or SIGINT: by channel the messages, first and last
// sequence number, and all deviations from the sequence.
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ifog/rate_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace {

volatile std::sig_atomic_t stop = 0;

struct Count {
  std::int64_t messages = 0, first = 0, last = 0;
  std::int64_t missing = 0;         // missing sequence numbers
  std::int64_t out_of_order = 0;    // sequence numbers that do not increase
  std::int64_t merged = 0;          // messages of several merged samples
  std::int64_t gap_flags = 0;       // messages that the daemon flagged as following a gap
  std::int64_t time_backwards = 0;  // utime does not increase
  std::int64_t clock_steps = 0;     // messages that the daemon flagged as following a set of the wall clock
  double angle_error = 0.0;         // largest |running angle - sum of increments|, rad; should be 0
  std::int64_t last_utime = 0;
  double angle = 0.0;
};

class Subscriber {
 public:
  void received(const lcm::ReceiveBuffer*, const std::string& channel, const ifog::rate_t* message) {
    Count& count = counts_[channel];
    if (count.messages == 0) {
      count.first = message->seq;
    } else {
      const std::int64_t step = message->seq - count.last;
      if (step <= 0) ++count.out_of_order;
      if (step > message->merged) count.missing += step - message->merged;
      if (message->utime <= count.last_utime) ++count.time_backwards;
      if (message->axes > 0) {
        const double expected = count.angle + message->delta_theta.at(0);
        count.angle_error = std::max(count.angle_error, std::abs(message->angle.at(0) - expected));
      }
    }
    if (message->merged != 1) ++count.merged;
    if ((message->flags & ifog::rate_t::FLAG_GAP) != 0) ++count.gap_flags;
    if ((message->flags & ifog::rate_t::FLAG_CLOCK_STEP) != 0) ++count.clock_steps;
    ++count.messages;
    count.last = message->seq;
    count.last_utime = message->utime;
    if (message->axes > 0) count.angle = message->angle.at(0);
  }

  [[nodiscard]] nlohmann::json report() const {
    nlohmann::json all = nlohmann::json::object();
    for (const auto& [channel, c] : counts_)
      all[channel] = {{"messages", c.messages},
                      {"first", c.first},
                      {"last", c.last},
                      {"missing", c.missing},
                      {"out_of_order", c.out_of_order},
                      {"merged", c.merged},
                      {"gap_flags", c.gap_flags},
                      {"time_backwards", c.time_backwards},
                      {"clock_steps", c.clock_steps},
                      {"angle", c.angle},
                      {"angle_error", c.angle_error}};
    return all;
  }

 private:
  std::map<std::string, Count> counts_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: lcm_count SECONDS CHANNEL...\n");
    return 2;
  }
  // LCM's queue drops silently if full; this one holds a minute of messages.
  lcm::LCM lcm;
  if (!lcm.good()) {
    std::fprintf(stderr, "lcm_count: LCM cannot be opened (is there a route for multicast?)\n");
    return 1;
  }
  Subscriber subscriber;
  for (int i = 2; i < argc; ++i)
    lcm.subscribe(argv[i], &Subscriber::received, &subscriber)->setQueueCapacity(100000);
  std::signal(SIGTERM, [](int) { stop = 1; });
  std::signal(SIGINT, [](int) { stop = 1; });

  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(std::strtod(argv[1], nullptr));
  while (stop == 0 && Clock::now() < end) lcm.handleTimeout(100);
  std::printf("%s\n", subscriber.report().dump().c_str());
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Prints what ifogd publishes for one sensor: each sample's number, and for each axis the angle increment in
// rad and the denoised rate in rad/s.
//
//   subscribe_cpp CHANNEL COUNT [LCM_URL]     subscribe_cpp IFOG_NOSE 100 'udpm://239.255.76.67:7667?ttl=0'
//
// Ends after COUNT messages. Build:  c++ subscribe.cpp $(pkg-config --cflags --libs ifogd-msgs)
#include <cstdio>
#include <ifog/rate_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <string>

class Printer {
 public:
  explicit Printer(long count) : left_(count) {}
  void handle(const lcm::ReceiveBuffer*, const std::string&, const ifog::rate_t* message) {
    std::printf("%lld", static_cast<long long>(message->seq));
    for (int axis = 0; axis < message->axes; ++axis)
      std::printf(" %.9g %.9g", message->delta_theta[axis], message->denoised[axis]);
    std::printf(" %s\n", (message->flags & ifog::rate_t::FLAG_GAP) != 0 ? "gap" : "-");
    std::fflush(stdout);
    --left_;
  }
  [[nodiscard]] bool done() const { return left_ <= 0; }

 private:
  long left_;
};

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: subscribe_cpp CHANNEL COUNT [LCM_URL]\n");
    return 2;
  }
  lcm::LCM lcm(argc > 3 ? argv[3] : "");
  if (!lcm.good()) {
    std::fprintf(stderr, "subscribe_cpp: no LCM\n");
    return 1;
  }
  Printer printer(std::atol(argv[2]));
  // By default LCM drops messages beyond 30 that wait.
  lcm.subscribe(argv[1], &Printer::handle, &printer)->setQueueCapacity(10000);
  while (!printer.done() && lcm.handle() == 0) {
  }
  return printer.done() ? 0 : 1;
}

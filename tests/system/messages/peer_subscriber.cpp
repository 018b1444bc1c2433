// SPDX-License-Identifier: Apache-2.0
// A subscriber like other programs on LCM, with types that lcm-gen made from their own definitions and no
// other code of this project. Prints each message as a line. peers.py builds it.     usage: peer_subscriber
// URL SECONDS
#include <algorithm>
#include <bot_core/ins_t.hpp>
#include <bot_core/kvh_raw_imu_batch_t.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <microstrain/ins_t.hpp>
#include <string>

namespace {

struct Printer {
  template <typename Ins>
  void ins(const lcm::ReceiveBuffer*, const std::string& channel, const Ins* m) {
    std::printf("%s %lld %.9f", channel.c_str(), static_cast<long long>(m->utime),
                static_cast<double>(m->device_time));
    for (const double* three : {m->gyro, m->accel, m->mag})
      for (int i = 0; i < 3; ++i) std::printf(" %.12g", three[i]);
    std::printf(" %g %g %g\n", m->quat[0], m->pressure, m->rel_alt);
  }
  void batch(const lcm::ReceiveBuffer*, const std::string& channel, const bot_core::kvh_raw_imu_batch_t* m) {
    std::printf("%s %lld", channel.c_str(), static_cast<long long>(m->utime));
    for (const auto& p : m->raw_imu) {
      std::printf(" %lld %lld", static_cast<long long>(p.utime), static_cast<long long>(p.packet_count));
      for (const double* three : {p.delta_rotation, p.linear_acceleration})
        for (int i = 0; i < 3; ++i) std::printf(" %.12g", three[i]);
    }
    std::printf("\n");
  }
};

}  // namespace

int main(int, char** argv) {
  lcm::LCM lcm(argv[1]);
  if (!lcm.good()) return 1;
  Printer printer;
  lcm.subscribe("INS", &Printer::ins<bot_core::ins_t>, &printer)->setQueueCapacity(100000);
  lcm.subscribe("MICROSTRAIN", &Printer::ins<microstrain::ins_t>, &printer)->setQueueCapacity(100000);
  lcm.subscribe("BATCH", &Printer::batch, &printer)->setQueueCapacity(100000);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(std::atoi(argv[2]));
  // Until there is no message for two seconds, or none at all.
  int heard = 0;
  for (int got = 1; got > 0 || (heard == 0 && std::chrono::steady_clock::now() < end); heard += got)
    got = std::max(0, lcm.handleTimeout(2000));
}

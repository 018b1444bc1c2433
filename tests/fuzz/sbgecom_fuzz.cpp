// SPDX-License-Identifier: Apache-2.0
// Any bytes: every one counted, and IMU_SHORT messages with the same numbers after packing.
#include <array>

#include "drivers/plugins/sbgecom/message.h"
#include "tests/fuzz/every_byte_counted.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ifog::sbgecom;
  using Finder = ifog::framing::FrameFinder<Protocol>;
  ifog::every_byte_counted(Finder(), Finder(), {data, size}, [](std::span<const std::uint8_t> frame) {
    Imu imu, again;
    if (!unpack(frame, imu) || imu.message != kImuShort) return;
    std::array<std::uint8_t, kLongestImuFrame> packed{};
    const std::size_t length = pack(imu, packed);
    if (!unpack(std::span(packed).first(length), again)) std::abort();
    for (std::size_t i = 0; i < 3; ++i) {
      // A device may use the high scale where the encoder does not: then equal to half a count of the finer
      // scale.
      const double off = again.rate_radps[i] - imu.rate_radps[i];
      if (off > 1e-8 || off < -1e-8 || again.acceleration_mps2[i] != imu.acceleration_mps2[i]) std::abort();
    }
    if (again.time_stamp_us != imu.time_stamp_us || again.temperature_degC != imu.temperature_degC)
      std::abort();
  });
  return 0;
}

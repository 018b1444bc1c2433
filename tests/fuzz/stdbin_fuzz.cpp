// SPDX-License-Identifier: Apache-2.0
// Any bytes: every one counted, and telegrams with the same blocks after packing.
#include <array>
#include <bit>

#include "drivers/plugins/stdbin/telegram.h"
#include "tests/fuzz/every_byte_counted.h"

namespace {

// Compares bits, so that NaN is equal to itself.
bool same(const std::optional<ifog::stdbin::Triad>& a, const std::optional<ifog::stdbin::Triad>& b) {
  if (a.has_value() != b.has_value()) return false;
  for (std::size_t i = 0; a && i < a->size(); ++i)
    if (std::bit_cast<std::uint32_t>((*a)[i]) != std::bit_cast<std::uint32_t>((*b)[i])) return false;
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ifog::stdbin;
  using Finder = ifog::framing::FrameFinder<Protocol>;
  ifog::every_byte_counted(Finder(), Finder(), {data, size}, [](std::span<const std::uint8_t> frame) {
    const Telegram telegram = unpack(frame);
    std::array<std::uint8_t, kLongestTelegram> packed{};
    const std::size_t length = pack(telegram, packed);
    const std::span<const std::uint8_t> bytes = std::span(packed).first(length);
    const auto announced = Protocol::at(bytes);
    if (announced.is != ifog::framing::Announced::Is::frame || announced.length != length ||
        !Protocol::intact(bytes))
      std::abort();
    const Telegram again = unpack(bytes);
    if (!same(telegram.rate_degps, again.rate_degps) ||
        !same(telegram.raw_rate_degps, again.raw_rate_degps) ||
        !same(telegram.raw_acceleration_mps2, again.raw_acceleration_mps2) ||
        !same(telegram.temperature_degC, again.temperature_degC) ||
        telegram.sensor_status != again.sensor_status || telegram.counter != again.counter ||
        telegram.validity_100us != again.validity_100us)
      std::abort();
  });
  return 0;
}

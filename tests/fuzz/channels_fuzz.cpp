// SPDX-License-Identifier: Apache-2.0
// Any configuration of an environment channel, and any message on its LCM channel: the field is read or
// rejected with one line. A value for the sensor is within the limits and has not jumped, or has jumped twice
// alike.
//
// 24 bytes: minimum, maximum, max_step; the field's name as configured, until a line feed; then messages,
// each with a byte for its type (0 … 2: with the type's hash in front) and one for its length.
#include <ifog/decode.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "daemon/channels/lcm_field.h"
#include "filters/chain/plausibility.h"

namespace {

void expect(bool holds) {
  if (!holds) std::abort();
}

std::optional<ifog::LcmField> field(const std::string& text) {
  try {
    return ifog::LcmField(text);
  } catch (const std::runtime_error& error) {
    const std::string line = error.what();
    expect(line.starts_with("sensor.channel.field = \"") && line.find('\n') == std::string::npos);
    return std::nullopt;
  }
}

// As accepted by read_limits() of the configuration.
ifog::Limits limits(const std::uint8_t* data) {
  std::array<double, 3> number{};
  std::memcpy(number.data(), data, sizeof number);
  ifog::Limits out;
  if (std::abs(number[0]) <= ifog::kMostChannel) out.minimum = number[0];
  if (std::abs(number[1]) <= ifog::kMostChannel) out.maximum = number[1];
  if (number[2] >= 0.0 && number[2] <= 2.0 * ifog::kMostChannel) out.max_step = number[2];
  return out.minimum < out.maximum ? out : ifog::Limits{};
}

std::vector<std::uint8_t> message(std::uint8_t type, std::span<const std::uint8_t> rest) {
  constexpr std::array kHash{&ifog::channel_t::getHash, &ifog::rate_t::getHash, &ifog::status_t::getHash};
  std::vector<std::uint8_t> out;
  for (int shift = 56; type < kHash.size() && shift >= 0; shift -= 8)
    out.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(kHash[type]()) >> shift));
  out.insert(out.end(), rest.begin(), rest.end());
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLimits = 24;
  if (size < kLimits) return 0;
  const ifog::Limits allowed = limits(data);
  const auto* const end = data + size;
  const auto* const line_end = std::find(data + kLimits, end, '\n');
  const std::optional<ifog::LcmField> wanted = field({data + kLimits, line_end});
  if (!wanted || line_end == end) return 0;
  ifog::PlausibleValue plausible(allowed, ifog::kMostChannel);
  std::optional<double> held, before;
  for (const auto* at = line_end + 1; end - at >= 2;) {
    const std::size_t length = std::min<std::size_t>(at[1], static_cast<std::size_t>(end - at - 2));
    const std::vector<std::uint8_t> bytes = message(at[0], {at + 2, length});
    at += 2 + length;
    double value = 0.0;
    std::int64_t utime = 0;
    if (!wanted->read(bytes, value, utime)) continue;
    expect(ifog::is_message(bytes));
    if (plausible.take(value)) {
      expect(std::abs(value) <= ifog::kMostChannel && value >= allowed.minimum && value <= allowed.maximum);
      expect(!held || std::abs(value - *held) <= allowed.max_step ||
             (before && std::abs(value - *before) <= allowed.max_step));
      held = value;
    }
    // Values beyond the limits neither confirm nor reject a jump.
    if (std::abs(value) <= ifog::kMostChannel && value >= allowed.minimum && value <= allowed.maximum)
      before = value;
  }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Any bytes as an LCM message of every type: rejected, or a message that the generated encoder writes
// unchanged. The first byte says if the type's hash is put in front, so that the fuzzer passes its check.
#include <ifog/decode.h>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "daemon/channels/lcm_field.h"

namespace {

template <typename Message>
void attempt(const std::uint8_t* data, std::size_t size, bool hashed) {
  std::vector<std::uint8_t> bytes;
  for (int shift = 56; hashed && shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(Message::getHash()) >> shift));
  bytes.insert(bytes.end(), data, data + size);
  Message message{};
  if (ifog::decode_message(bytes, message)) {
    // Only strings that contain a 0 may be encoded differently.
    if (static_cast<std::size_t>(message.getEncodedSize()) != bytes.size()) std::abort();
    std::vector<std::uint8_t> again(bytes.size());
    if (message.encode(again.data(), 0, static_cast<int>(again.size())) < 0) std::abort();
  }
  for (const char* field :
       {"hull_degC", "raw[0]", "denoised[2]", "nis_mean[1]", "channel_value[supply_V]", "latency_p99_us"}) {
    double value = 0.0;
    std::int64_t utime = 0;
    (void)ifog::LcmField(field).read(bytes, value, utime);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bool hashed = (data[0] & 1U) != 0;
  attempt<ifog::channel_t>(data + 1, size - 1, hashed);
  attempt<ifog::imu_t>(data + 1, size - 1, hashed);
  attempt<ifog::inertial_t>(data + 1, size - 1, hashed);
  attempt<bot_core::ins_t>(data + 1, size - 1, hashed);
  attempt<bot_core::kvh_raw_imu_batch_t>(data + 1, size - 1, hashed);
  attempt<senlcm::kvh_dsp3000_t>(data + 1, size - 1, hashed);
  attempt<ifog::rate_t>(data + 1, size - 1, hashed);
  attempt<ifog::status_t>(data + 1, size - 1, hashed);
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Any frames for the dbc driver, on a bus with multiplexed axes, long frames and several frames per sample.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "drivers/plugins/dbc/decoder.h"

namespace {

constexpr const char* kBus =
    "BO_ 1 A: 8 X\n SG_ S M : 0|4@1+ (1,0) [0|0] \"\" X\n SG_ N : 4|4@1+ (1,0) [0|0] \"\" X\n"
    " SG_ X m1 : 8|32@1- (1,0) [0|0] \"rad/s\" X\n SG_ Y m2 : 15|33@0- (1E-6,0) [0|0] \"deg/s\" X\n"
    " SG_ Y_Sign : 63|1@1+ (1,0) [0|0] \"\" X\n"
    "BO_ 2 B: 64 X\n SG_ Z : 300|64@1- (1,0) [0|0] \"rad/s\" X\n SG_ N : 3|4@0+ (1,0) [0|0] \"\" X\n"
    " SG_ C : 16|32@1+ (1,0) [0|0] \"us\" X\n"
    "BO_ 2147483651 T: 2 X\n SG_ T : 7|16@0- (0.01,0) [0|0] \"degC\" X\n"
    "SIG_VALTYPE_ 1 X : 1;\nSIG_VALTYPE_ 2 Z : 2;\n";

const ifog::dbc::Picks& picks() {
  static ifog::dbc::Picks picks;
  if (!picks.axes.empty()) return picks;
  using ifog::dbc::Pick;
  picks.database = ifog::dbc::parse_database(kBus, "bus");
  const auto pick = [&](std::size_t m, std::size_t s) {
    return Pick{&picks.database.messages[m], &picks.database.messages[m].signals[s]};
  };
  picks.axes = {{"x", pick(0, 2), 1.0, nullptr},
                {"y", pick(0, 3), 0.017, pick(0, 4).signal},
                {"z", pick(1, 0), 1.0, nullptr}};
  picks.counter = {pick(0, 1), pick(1, 1)};
  picks.counter_modulus = 16;
  picks.time = pick(1, 2);
  picks.seconds_per_unit = 1e-6;
  picks.environments = {{"temperature_degC", pick(2, 0), {}}};
  return picks;
}

}  // namespace

// Each frame is read as id, flags, length and that many bytes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ifog::dbc::Decoder decoder(picks());
  std::size_t samples = 0;
  std::size_t frames = 0;
  for (std::size_t at = 0; at + 3 <= size;) {
    ifog_can_frame frame{};
    frame.id = data[at] % 4U;
    frame.flags = data[at + 1];
    frame.length = data[at + 2];  // above 64 too: a decoder must not trust it
    at += 3;
    const std::size_t n = std::min<std::size_t>({frame.length, sizeof frame.data, size - at});
    std::memcpy(frame.data, data + at, n);
    at += n;
    ++frames;
    decoder.decode(
        frame,
        [](void* sink, const ifog_sample* sample) {
          ++*static_cast<std::size_t*>(sink);
          if (sample->sequence >= 16 || sample->valid_axes > 7) std::abort();
          for (unsigned i = 0; i < 3; ++i)
            if ((sample->valid_axes & 1U << i) != 0 && !std::isfinite(sample->value[i])) std::abort();
        },
        &samples);
  }
  if (samples > frames || decoder.counters().frames_good > frames) std::abort();
  return 0;
}

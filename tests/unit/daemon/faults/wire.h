// SPDX-License-Identifier: Apache-2.0
// What a gyro's line carries in a run with random faults, and what of it is intact: the oracle of the books.
// It is put together from the frames that went in, and knows nothing of how they are found again.
#pragma once

#include <bitset>
#include <cstdint>
#include <random>
#include <vector>

#include "drivers/host/driver_instance.h"

namespace ifog {

// A sample as it stands in the stream, whole.
struct Sent {
  std::size_t begin = 0, end = 0;  // bytes or frames of the stream
  std::uint32_t sequence = 0;
  bool valid = true;
  double rate = 0.0;  // axis 0, as a float holds it
};

// What the intact samples among the first `given` bytes or frames say.
struct Truth {
  std::uint64_t decoded = 0, repeated = 0, invalid = 0;
  std::uint64_t frames_good = 0, frames_refused = 0, frames_other = 0;  // CAN
  double angle = 0.0;
};

class Wire {
 public:
  static constexpr double kPeriod_s = 1e-3;
  static constexpr std::int64_t kBegin_ns = 1'000'000'000'000;  // arrival of the first

  // can: three kinds of frames on a bus, single-axis; else the KVH 1750's bytes, three axes.
  Wire(std::mt19937& random, bool can, int samples);

  // A driver as the configuration would make it.
  static DriverInstance driver(bool can);

  [[nodiscard]] bool can() const { return can_; }
  [[nodiscard]] std::size_t size() const { return can_ ? frames.size() : bytes.size(); }
  // Of the first `n`: made up from their place in the stream, so that no load of the machine is a gap.
  [[nodiscard]] std::int64_t arrival_ns(std::size_t n) const;
  // A frame over a cut is in two parts, and none.
  [[nodiscard]] Truth truth(const std::vector<std::size_t>& cuts, std::size_t given) const;

  std::vector<std::uint8_t> bytes;
  std::vector<ifog_can_frame> frames;

 private:
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  double rate() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }
  // What befalls a sample: of every twelve one, half of those two at once. On a bus `damaged` is a frame of
  // the sensor's temperature before it; a line overtakes nothing.
  enum OfSample : std::uint8_t { kImpossible, kInvalid, kLost, kDamaged, kShort, kNoise, kTwice, kOvertaken };
  static constexpr int kFates = 8;
  using Fates = std::bitset<kFates>;
  struct Held {
    ifog_can_frame frame;
    Sent sent;
  };
  Fates draw_fates();
  void add_frame(const Held& held, std::int64_t arrival_ns);
  void add_bytes(std::uint32_t number);
  void add_frames(std::uint32_t number);
  void add_other_frame(std::int64_t arrival_ns);

  enum class Fate : std::uint8_t { good, refused, other };
  std::mt19937& random_;
  bool can_;
  DriverInstance driver_;
  std::vector<Sent> intact_;
  std::vector<Held> held_;  // overtaken by the next
  std::vector<Fate> fate_;  // of each CAN frame
};

}  // namespace ifog

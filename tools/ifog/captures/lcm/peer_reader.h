// SPDX-License-Identifier: Apache-2.0
// Reads one channel of messages with rates that are not ifog.rate_t, as rate_t: types of other programs, see
// msgs/peers, and ours with specific force. The hash identifies the type.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <ifog/rate_t.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ifog::tools {

struct PeerSample {
  enum class Kind { rate, delta, angle };
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  Kind kind = Kind::rate;
  std::int64_t utime = 0;              // µs since the epoch
  std::int64_t count = 0;              // the sensor's own, if the type has one
  std::int64_t device_ns = -1;         // the device's clock; −1: none
  std::int32_t flags = 0, merged = 1;  // as in rate_t
  // Rad/s, or rad since the previous sample, or accumulated rad
  std::array<double, 3> value{kUnknown, kUnknown, kUnknown};
  std::array<double, 3> specific_force_mps2{kUnknown, kUnknown, kUnknown};
  double temperature_degC = kUnknown;
};

struct PeerType {
  std::string_view name;  // "bot_core.ins_t"
  std::int64_t hash;
  std::size_t axes;  // 1 or 3
  bool specific_force, temperature;
  enum class Count { none, whole, repeats } count;  // repeats: messages contain earlier samples again
  std::int64_t modulus;                             // of the count; 0: no rollover
  // Appends a message's samples, oldest first. False: not of this type.
  bool (*unpack)(std::span<const std::uint8_t> message, std::vector<PeerSample>& out);
};

// Type of the message; null: none of these.
const PeerType* peer_type(std::span<const std::uint8_t> message);

// A rate with the values of PeerReader::extra_columns().
struct MeasuredRate : rate_t {
  std::vector<double> extra;
};

class PeerReader {
 public:
  explicit PeerReader(const PeerType& type) : type_(&type) {}

  [[nodiscard]] const PeerType& type() const { return *type_; }
  // Columns of specific force and temperature, if the type has them.
  [[nodiscard]] std::vector<std::string> extra_columns() const;

  // First pass over the channel: the sensor's period, and if the device's clock is usable.
  void look_at(std::span<const std::uint8_t> message);
  // Second pass: new samples in the order of their counts. A packet's angle is divided by the period, so that
  // jitter of the stamps adds no noise. False: not of this type.
  bool take(std::span<const std::uint8_t> message, const std::function<void(MeasuredRate&&)>& sink);

 private:
  struct Place {
    std::int64_t count, utime, device_ns;
  };
  bool unpack(std::span<const std::uint8_t> message);  // into samples_
  [[nodiscard]] std::int64_t unwrapped(const PeerSample& sample) const;
  bool again(const PeerSample& sample);
  [[nodiscard]] double period_s();

  const PeerType* type_;
  std::vector<PeerSample> samples_;
  std::optional<Place> last_;
  std::vector<double> steps_us_;  // between successive samples
  double advance_us_ = 0.0, device_advance_us_ = 0.0;
  std::optional<double> period_s_;
  bool second_look_ = false;
  double angle_ = PeerSample::kUnknown;
};

}  // namespace ifog::tools

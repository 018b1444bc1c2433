// SPDX-License-Identifier: Apache-2.0
// Messages that carry rates and are no ifog.rate_t: of other programs on LCM, see msgs/peers, and ours with
// specific force. A type is known by its hash.
// One channel of such a type is read as the messages that our readers of logs work on.
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
  std::int64_t utime = 0;                                     // µs since the epoch
  std::int64_t count = 0;                                     // the sensor's own, where the type has one
  std::int64_t device_ns = -1;                                // the device's clock; −1: none
  std::int32_t flags = 0, merged = 1;                         // as in rate_t
  std::array<double, 3> value{kUnknown, kUnknown, kUnknown};  // rad/s, or rad since the sample before, or rad
  std::array<double, 3> specific_force_mps2{kUnknown, kUnknown, kUnknown};
  double temperature_degC = kUnknown;
};

struct PeerType {
  std::string_view name;  // "bot_core.ins_t"
  std::int64_t hash;
  std::size_t axes;  // 1 or 3
  bool specific_force, temperature;
  enum class Count { none, whole, repeats } count;  // repeats: messages bring samples again
  std::int64_t modulus;                             // the count rolls over after so many; 0: it does not
  // The samples of a message, the oldest first. False: it is none of the type.
  bool (*unpack)(std::span<const std::uint8_t> message, std::vector<PeerSample>& out);
};

// That of the message; null: none of these.
const PeerType* peer_type(std::span<const std::uint8_t> message);

// A rate and what was measured with it, by PeerReader::beside().
struct MeasuredRate : rate_t {
  std::vector<double> beside;
};

class PeerReader {
 public:
  explicit PeerReader(const PeerType& type) : type_(&type) {}

  [[nodiscard]] const PeerType& type() const { return *type_; }
  // Columns of specific force and temperature, where the type has them.
  [[nodiscard]] std::vector<std::string> beside() const;

  // The first look at every message of the channel: the sensor's period, and whether its clock is one.
  void look_at(std::span<const std::uint8_t> message);
  // The second: the samples that were in no message before, in the order of their counts. An angle that a
  // packet turned is divided by the period, so that the jitter of stamps is no noise of the rate. False: the
  // message is none of the type.
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
  std::optional<Place> first_, last_;
  std::vector<double> steps_us_;  // between samples that follow one another
  double advance_us_ = 0.0, device_advance_us_ = 0.0;
  std::optional<double> period_s_;
  bool second_look_ = false;
  double angle_ = PeerSample::kUnknown;
};

}  // namespace ifog::tools

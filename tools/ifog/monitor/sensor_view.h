// SPDX-License-Identifier: Apache-2.0
// What is shown of a sensor: figures of the last interval, losses, the recent rate; and these as lines.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <ifog/rate_t.hpp>
#include <ifog/status_t.hpp>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "msgs/flag_names.h"
#include "tools/ifog/captures/lcm/lcm_loss.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/denoise/moments.h"

namespace ifog::tools {

struct AxisView {
  double rate_radps = 0.0;                          // mean of denoised
  double noise_radps = 0.0, raw_noise_radps = 0.0;  // standard deviations; NaN: fewer than two samples
  double angle_rad = 0.0;
};

class SensorView {
 public:
  // Two status messages are missing: a killed daemon does not report its end.
  static constexpr double kStale_s = 2.5;
  // Number of intervals in the history.
  static constexpr std::size_t kRemembered = 120;
  struct Second {
    double raw_low_radps, raw_high_radps, rate_radps;  // NaN: no data
  };

  void take(const rate_t& message);
  void take(status_t message);
  // Computes the figures from the messages since the last call.
  void end_interval(double seconds);
  // Counts losses from now on.
  void forget_losses();

  [[nodiscard]] std::int64_t messages() const { return messages_; }
  [[nodiscard]] bool judged() const { return judged_; }  // an interval has ended
  [[nodiscard]] bool shown() const { return shown_; }    // an interval with rates or a status has ended
  // Age of the last message, s, at the end of the interval.
  [[nodiscard]] double silent_s() const { return silent_s_; }
  [[nodiscard]] bool silent() const { return silent_s_ > kStale_s; }
  // Null: none received, or too old.
  [[nodiscard]] const status_t* live_status() const {
    return status_.message && status_.age_s <= kStale_s ? &*status_.message : nullptr;
  }
  [[nodiscard]] double status_age_s() const { return status_.age_s; }
  [[nodiscard]] bool two_publishers() const { return way_.two_publishers(); }
  [[nodiscard]] double message_rate_hz() const { return rate_hz_; }
  [[nodiscard]] const std::string& model() const { return model_; }
  [[nodiscard]] const std::vector<AxisView>& axes() const { return axes_; }  // empty: no data
  [[nodiscard]] std::size_t axis_count() const { return sums_.size(); }      // of the last message
  [[nodiscard]] const std::deque<Second>& history(std::size_t axis) const { return history_[axis]; }
  [[nodiscard]] const std::optional<status_t>& status() const { return status_.message; }

  struct Count {
    std::string_view name;
    std::int64_t count;
  };
  // Number of messages in the interval per flag, without zeros.
  [[nodiscard]] std::vector<Count> flags() const;
  // Losses, rejections and skips between device and here, without zeros.
  [[nodiscard]] std::vector<Count> losses() const;

 private:
  struct Sums {
    Moments denoised, raw;
    double angle = 0.0;
    double raw_low = std::numeric_limits<double>::quiet_NaN(), raw_high = raw_low;
  };
  [[nodiscard]] std::vector<Count> all_losses() const;

  std::int64_t messages_ = 0, in_interval_ = 0;
  bool received_ = false;  // any message in the interval
  double silent_s_ = 0.0;
  bool judged_ = false, shown_ = false;
  double rate_hz_ = 0.0;
  LcmLoss way_;
  std::string model_;
  std::vector<Sums> sums_;
  std::vector<AxisView> axes_;
  std::vector<std::deque<Second>> history_;
  std::array<std::int64_t, kFlagNames.size()> flagged_{}, flagged_before_{};
  struct Status {
    std::optional<status_t> message;
    double age_s = 0.0;
    bool received = false;  // in the interval
  } status_;
  std::vector<std::int64_t> forgotten_;
};

enum class RateUnit {
  automatic,  // °/h below 0.1 °/s, °/s above
  degree_per_hour,
  degree_per_second,
  radian_per_second,
};

struct LineStyle {
  std::size_t width = 0;  // columns; 0: unlimited
  bool details = true;    // latency, balances, channels
  RateUnit unit = RateUnit::automatic;
};

// Information in this computer's files about a sensor on LCM. Its messages contain neither driver nor
// transport, and only the model's identity.
struct KnownSensor {
  std::string driver;  // "kvh1750, serial /dev/ttyUSB0"
  // "nose.toml of 2026-11-27 01:30", and that model's identity; "" without a model
  std::string model, identity;
  std::string proposal;            // one line; "" without a proposal
  std::set<std::string> channels;  // configured in addition to those in its frames
};

const char* tone_name(Tone tone);

// State of the sensor as a colour.
Tone tone_of(const SensorView& sensor);

// Control characters in names from the network are removed. `known`: null if nothing is known.
std::vector<ShownLine> view_lines(std::string_view name, const SensorView& sensor, const LineStyle& style,
                                  const KnownSensor* known = nullptr);

// Joins parts into as many lines as necessary; lines after the first are indented by four.
std::vector<std::string> wrapped(const std::vector<std::string>& parts, std::string_view separator,
                                 std::size_t width);

}  // namespace ifog::tools

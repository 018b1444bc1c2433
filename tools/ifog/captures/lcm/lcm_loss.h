// SPDX-License-Identifier: Apache-2.0
// Counts messages that LCM lost between the daemon and this process, by the messages' numbers.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <ifog/rate_t.hpp>
#include <optional>
#include <string>
#include <utility>

#include "drivers/timeline/two_devices.h"

namespace ifog::tools {

// For a warning.
inline std::string two_publishers_sent_on(const std::string& channels) {
  return "two publishers sent on " + channels +
         " (two daemons, or a log played at the same time): their messages are mixed";
}

class LcmLoss {
 public:
  // Takes a message of one sensor. Returns how many are now known to be lost; a message that arrives within
  // kWindow of its place is not. With two publishers on the channel no loss is known.
  std::int64_t take(const rate_t& message) {
    const bool late = comes_late(message.seq);
    publishers_.saw(static_cast<std::uint32_t>(message.seq), std::uint64_t{1} << 32U, late);
    if (publishers_.found()) {
      two_publishers_ = true;
      suspect_ = 0;
      last_.reset();
      received_ = ~std::uint64_t{0};
      return 0;
    }
    if (late) {
      const std::uint64_t place = std::uint64_t{1} << static_cast<unsigned>(last_->seq - message.seq);
      if ((received_ & place) == 0) --(suspect_ > 0 ? suspect_ : lost_);
      received_ |= place;
      return 0;
    }
    // A gap in the numbers without the daemon's gap or merge flag is a loss on the way.
    const bool announced =
        (message.flags & rate_t::FLAG_GAP) != 0 || (message.flags & rate_t::FLAG_MERGED) != 0;
    std::int64_t lost = 0;
    if (last_ && !announced && last_->seq >= 0 && message.seq > last_->seq)
      lost = message.seq - last_->seq - 1;
    if (static_cast<double>(lost) > most_since_last(message)) {
      ++restarts_;
      lost = 0;
    }
    if (!announced && message.dt > 0.0 && message.dt < kLongestStep_s) {
      steps_s_ += message.dt;
      ++steps_;
    }
    const std::int64_t by = last_ && message.seq > last_->seq ? message.seq - last_->seq : 0;
    last_ = {message.seq, message.utime, message.sensor_time_ns};
    suspect_ += lost;
    if (!publishers_.suspected()) lost_ += std::exchange(suspect_, 0);
    return pass(by == 0 ? kWindow : by, lost);
  }
  [[nodiscard]] std::int64_t lost() const { return lost_ + suspect_; }
  // Missing numbers that may still arrive; lost if nothing more arrives.
  [[nodiscard]] std::int64_t awaited() const {
    return std::popcount(~received_ & ((std::uint64_t{1} << kWindow) - 1));
  }
  // How often a number was too high for the elapsed time: the sequence restarted, and no loss is known.
  [[nodiscard]] std::int64_t restarts() const { return restarts_; }
  // True if two sequences are on this channel: from two daemons, or from a daemon and a log that is played.
  [[nodiscard]] bool two_publishers() const { return publishers_.found(); }
  [[nodiscard]] bool had_two_publishers() const { return two_publishers_; }

 private:
  struct Place {
    std::int64_t seq, utime, sensor_time_ns;
  };
  static constexpr double kShortestStep_s = 1e-5, kLongestStep_s = 100.0;
  // Margins, because steps are a mean and times of samples are fitted.
  static constexpr double kTimes = 2.0, kSlack_s = 1.0;

  [[nodiscard]] bool comes_late(std::int64_t seq) const {
    return last_ && seq < last_->seq && seq >= 0 && last_->seq - seq < kWindow;
  }
  // Advances the window by `by` numbers, `lost` of which are missing. Returns how many leave it missing.
  std::int64_t pass(std::int64_t by, std::int64_t lost) {
    std::int64_t gone = std::max<std::int64_t>(0, lost - (kWindow - 1));
    for (std::int64_t place = std::max<std::int64_t>(0, kWindow - by); place < kWindow; ++place)
      gone += (received_ >> static_cast<unsigned>(place) & 1U) == 0 ? 1 : 0;
    received_ = by < kWindow ? received_ << static_cast<unsigned>(by) : 0;
    const std::uint64_t holes =
        by < kWindow ? (std::uint64_t{1} << static_cast<unsigned>(by)) - 1 : ~std::uint64_t{0};
    received_ |= lost > 0 ? std::uint64_t{1} : holes | 1U;
    return gone;
  }
  // Most samples since the last message at the sensor's rate; uses the clock that advanced more, because
  // either may be set back.
  [[nodiscard]] double most_since_last(const rate_t& message) const {
    if (!last_) return 0.0;
    const auto since = [](std::int64_t now, std::int64_t before) {
      return static_cast<double>(now) - static_cast<double>(before);
    };
    double elapsed_s = since(message.utime, last_->utime) * 1e-6;
    if (message.sensor_time_ns != -1 && last_->sensor_time_ns != -1)
      elapsed_s = std::max(elapsed_s, since(message.sensor_time_ns, last_->sensor_time_ns) * 1e-9);
    const double step_s = steps_ > 0 ? steps_s_ / static_cast<double>(steps_) : kShortestStep_s;
    return kTimes * (std::max(elapsed_s, 0.0) + kSlack_s) / step_s;
  }

  std::optional<Place> last_;
  static constexpr std::int64_t kWindow = 16;  // messages; larger than any reordering of a network
  std::uint64_t received_ =
      ~std::uint64_t{0};  // bit n: the n-th message before the last one was received or never sent
  bool two_publishers_ = false;
  TwoDevices publishers_;
  std::int64_t suspect_ = 0;  // lost, unless two interleaved sequences are found
  std::int64_t lost_ = 0, restarts_ = 0, steps_ = 0;
  double steps_s_ = 0.0;
};

}  // namespace ifog::tools

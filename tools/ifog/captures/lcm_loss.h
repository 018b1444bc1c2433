// SPDX-License-Identifier: Apache-2.0
// What LCM, which promises nothing, lost on the way from the daemon to here, by the numbers of the messages.
#pragma once

#include <algorithm>
#include <cstdint>
#include <ifog/rate_t.hpp>
#include <optional>

#include "drivers/timeline/two_devices.h"

namespace ifog::tools {

class LcmLoss {
 public:
  // The messages of one sensor. Returns how many are missing before this one. One that comes out of order was
  // not lost; while two publishers send on the channel nothing is known to be.
  std::int64_t take(const rate_t& message) {
    publishers_.saw(static_cast<std::uint32_t>(message.seq), std::uint64_t{1} << 32U,
                    comes_late(message.seq));
    if (publishers_.found()) {
      last_.reset();
      return 0;
    }
    if (comes_late(message.seq)) {
      const std::uint64_t place = std::uint64_t{1} << static_cast<unsigned>(last_->seq - message.seq);
      lost_ -= (came_ & place) == 0 && lost_ > 0 ? 1 : 0;
      came_ |= place;
      return 0;
    }
    const std::int64_t by = last_ ? message.seq - last_->seq : 1;
    came_ = (by > 0 && by < 64 ? came_ << static_cast<unsigned>(by) : 0) | 1U;
    // A number passed over without the daemon's own gap flag or a merge was lost on the way.
    const bool told = (message.flags & rate_t::FLAG_GAP) != 0 || (message.flags & rate_t::FLAG_MERGED) != 0;
    std::int64_t lost = 0;
    if (last_ && !told && last_->seq >= 0 && message.seq > last_->seq) lost = message.seq - last_->seq - 1;
    if (static_cast<double>(lost) > most_since_last(message)) {
      ++began_anew_;
      lost = 0;
    }
    if (!told && message.dt > 0.0 && message.dt < kLongestStep_s) {
      steps_s_ += message.dt;
      ++steps_;
    }
    last_ = {message.seq, message.utime, message.sensor_time_ns};
    lost_ += lost;
    return lost;
  }
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  // How often the number was one that no sample of this sensor can have had by then: nothing is known to be
  // lost.
  [[nodiscard]] std::int64_t began_anew() const { return began_anew_; }
  // Two sequences run on this channel: of two daemons, or of a daemon and a log that is played.
  [[nodiscard]] bool two_publishers() const { return publishers_.found(); }

 private:
  struct Place {
    std::int64_t seq, utime, sensor_time_ns;
  };
  static constexpr double kShortestStep_s = 1e-5, kLongestStep_s = 100.0;
  // Steps are a mean and times of samples are fitted ones.
  static constexpr double kTimes = 2.0, kSlack_s = 1.0;

  [[nodiscard]] bool comes_late(std::int64_t seq) const {
    return last_ && seq < last_->seq && seq >= 0 && last_->seq - seq < 64;
  }
  // Samples that fit in between at the sensor's rate, by the clock that tells of more; both go back where one
  // of them is set.
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
  std::uint64_t came_ = 0;  // bit n: the message n before the last
  TwoDevices publishers_;
  std::int64_t lost_ = 0, began_anew_ = 0, steps_ = 0;
  double steps_s_ = 0.0;
};

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
// Puts messages of one sensor into the order of their numbers: LCM (UDP multicast) may exchange neighbours.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ifog/rate_t.hpp>
#include <iterator>
#include <map>
#include <utility>

namespace ifog {

// Message: rate_t or derived from it.
template <typename Message = rate_t>
class InOrder {
 public:
  // Calls `sink(const Message&)` in order. After a gap, messages wait for the missing one or until kWindow
  // are waiting. A message that arrives still later is passed on at once.
  template <typename Sink>
  void take(Message message, Sink&& sink) {
    message.seq = std::clamp<std::int64_t>(message.seq, 0, INT64_MAX / 2);  // of a foreign log
    const std::int64_t by = message.seq - last_;
    const bool restarted = started_ && by <= -kRestart;
    if (restarted) flush(sink);
    const bool continues =
        (message.flags & rate_t::FLAG_GAP) != 0 || by == std::max<std::int64_t>(1, message.merged);
    if (!started_ || restarted || (started_ && by <= 0) || (continues && held_.empty()))
      return hand_on(message, sink);
    const std::int64_t seq = message.seq;
    held_.emplace(seq, std::move(message));
    while (!held_.empty() && (follows(held_.begin()->second) || held_.size() > kWindow)) release(sink);
  }
  // Passes on what is waiting, at the end.
  template <typename Sink>
  void flush(Sink&& sink) {
    while (!held_.empty()) release(sink);
  }

 private:
  static constexpr std::size_t kWindow = 16;     // messages; larger than any reordering of a network
  static constexpr std::int64_t kRestart = 256;  // numbers back: the daemon restarted

  [[nodiscard]] bool follows(const Message& message) const {
    return message.seq - last_ <= std::max<std::int64_t>(1, message.merged) ||
           (message.flags & rate_t::FLAG_GAP) != 0;
  }
  template <typename Sink>
  void release(Sink&& sink) {
    const auto node = held_.extract(held_.begin());
    hand_on(node.mapped(), sink);
  }
  template <typename Sink>
  void hand_on(const Message& message, Sink&& sink) {
    const bool late = started_ && message.seq <= last_ && message.seq > last_ - kRestart;
    if (!late) last_ = message.seq;
    started_ = true;
    sink(message);
    while (!held_.empty() && follows(held_.begin()->second)) release(sink);
  }

  std::map<std::int64_t, Message> held_;
  std::int64_t last_ = 0;
  bool started_ = false;
};

}  // namespace ifog

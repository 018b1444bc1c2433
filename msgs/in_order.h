// SPDX-License-Identifier: Apache-2.0
// Messages of one sensor in the order of their numbers: LCM (UDP multicast) may deliver neighbours exchanged.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ifog/rate_t.hpp>
#include <iterator>
#include <map>
#include <utility>

namespace ifog {

// Message: a rate_t, or that with more.
template <typename Message = rate_t>
class InOrder {
 public:
  // Hands on, in order, what may go: `sink(const Message&)`. A message whose predecessor is missing waits
  // until that has come, or kWindow behind it have. One that comes later still is handed on as it comes.
  template <typename Sink>
  void take(Message message, Sink&& sink) {
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
  // At the end.
  template <typename Sink>
  void flush(Sink&& sink) {
    while (!held_.empty()) release(sink);
  }

 private:
  static constexpr std::size_t kWindow = 16;     // messages: more than a network exchanges
  static constexpr std::int64_t kRestart = 256;  // numbers back: the daemon counts from its start again

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

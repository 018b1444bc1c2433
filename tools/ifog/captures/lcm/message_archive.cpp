// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/lcm/message_archive.h"

#include <ifog/decode.h>

#include <utility>

#include "drivers/ifog/quoted.h"
#include "msgs/channel_name.h"
#include "tools/ifog/console/errors.h"

namespace ifog::tools {

void MessageArchive::open(std::int64_t now_ns, std::int64_t wall_ns) {
  archive_.turn(now_ns, wall_ns);
  if (archive_.error() != 0) throw refusal("{}: {}", archive_.path(), archive_.complaint());
}

void MessageArchive::tell_lost(std::int64_t wall_ns) {
  if (unreported_ == 0) return;
  const std::uint64_t lost[2] = {std::exchange(unreported_, 0), std::exchange(unreported_bytes_, 0)};
  archive_.add({FlightKind::lost, 0, 0, 0, wall_ns},
               {reinterpret_cast<const std::uint8_t*>(lost), sizeof lost});
}

void MessageArchive::look_at(const std::string& channel, std::span<const std::uint8_t> message) {
  rate_t rate{};
  if (channel_name(channel).content == ChannelContent::rate &&
      decode_message(message.data(), message.size(), rate))
    unreported_ += static_cast<std::uint64_t>(ways_[channel].take(rate));
}

void MessageArchive::take(const std::string& channel, std::span<const std::uint8_t> message,
                          std::int64_t came_utime, std::int64_t now_ns, std::int64_t wall_ns) {
  ++books_.received;
  // Also if it is not stored: a message lost here must not count as lost on the way.
  look_at(channel, message);
  payload_.assign(channel.begin(), channel.end());
  payload_.insert(payload_.end(), message.begin(), message.end());
  if (archive_.full()) archive_.turn(now_ns, wall_ns);
  if (archive_.full() || payload_.size() > kMostFlightPayload) {
    ++books_.lost_here;
    ++unreported_;
    unreported_bytes_ += message.size();
    return;
  }
  tell_lost(wall_ns);
  archive_.add({FlightKind::message, 0, static_cast<std::uint16_t>(channel.size()), 0, came_utime * 1000},
               payload_);
}

void MessageArchive::close(std::int64_t now_ns, std::int64_t wall_ns) {
  for (const auto& [channel, way] : ways_) unreported_ += static_cast<std::uint64_t>(way.awaited());
  if (!archive_.full()) tell_lost(wall_ns);
  archive_.close(now_ns, wall_ns);
  books_.lost_here += archive_.lost_at_close().deliveries;
}

MessageArchive::Books MessageArchive::books() const {
  Books out = books_;
  for (const auto& [channel, way] : ways_) {
    out.lost_on_way += static_cast<std::uint64_t>(way.lost());
    out.restarts += static_cast<std::uint64_t>(way.restarts());
    if (way.had_two_publishers())
      out.two_publishers += (out.two_publishers.empty() ? "" : ", ") + printable(channel);
  }
  return out;
}

}  // namespace ifog::tools

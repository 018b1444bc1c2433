// SPDX-License-Identifier: Apache-2.0
#include "daemon/recorder/tape.h"

#include <algorithm>
#include <cstring>

namespace ifog {
namespace {

constexpr std::size_t kHead = sizeof(FlightEntryHead);
constexpr std::size_t kFrameHead = 6;  // u32 id, u8 flags, u8 length

}  // namespace

Tape::Tape(std::size_t bytes) : queue_(std::max(bytes, kLeastBytes)) {}

void Tape::push(const FlightEntryHead& head, const void* payload, std::size_t length) noexcept {
  FlightEntryHead whole = head;
  whole.length = static_cast<std::uint32_t>(length);
  queue_.push(reinterpret_cast<const std::uint8_t*>(&whole), sizeof whole);
  if (length > 0) queue_.push(static_cast<const std::uint8_t*>(payload), length);
}

void Tape::push_state(std::span<const ChannelValue> channels, std::int64_t wall_shift_ns) noexcept {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].same(recorded_[i])) continue;
    recorded_[i] = channels[i];
    push({FlightKind::channel, 0, static_cast<std::uint16_t>(i), 0, channels[i].time_ns}, &channels[i].value,
         sizeof channels[i].value);
  }
  if (wall_shift_ns == wall_shift_ns_) return;
  wall_shift_ns_ = wall_shift_ns;
  push({FlightKind::wall, 0, 0, 0, 0}, &wall_shift_ns, sizeof wall_shift_ns);
}

void Tape::push_frame(const ifog_can_frame& frame, std::uint8_t flags, std::int64_t read_ns) noexcept {
  std::array<std::uint8_t, kFrameHead + sizeof frame.data> bytes;
  std::memcpy(bytes.data(), &frame.id, 4);
  bytes[4] = frame.flags;
  bytes[5] = frame.length;
  std::memcpy(bytes.data() + kFrameHead, frame.data, frame.length);
  const bool timed = frame.arrival_ns != 0;
  push({FlightKind::can, static_cast<std::uint8_t>(flags | (timed ? 0 : kFlightReadTime)), 0, 0,
        timed ? frame.arrival_ns : read_ns},
       bytes.data(), kFrameHead + frame.length);
}

void Tape::put(const Delivery& delivery, std::int64_t read_ns, std::span<const ChannelValue> channels,
               std::int64_t wall_shift_ns) noexcept {
  std::size_t frame_bytes = 0;
  for (const ifog_can_frame& frame : delivery.frames) frame_bytes += kFrameHead + frame.length;
  const std::size_t bytes = delivery.bytes.size() + frame_bytes;
  counters_.deliveries.add(1);
  counters_.bytes.add(bytes);
  // All that may be pushed below.
  const std::size_t needed = kHead + delivery.bytes.size() + delivery.frames.size() * kHead + frame_bytes +
                             (channels.size() + 1) * (kHead + 8) + (kHead + 16);
  if (queue_.write_available() < needed) {
    counters_.lost_deliveries.add(1);
    counters_.lost_bytes.add(bytes);
    ++untold_deliveries_;
    untold_bytes_ += bytes;
    reopened_ = reopened_ || delivery.restarted;
    return;
  }
  if (untold_deliveries_ > 0) {
    const std::array<std::uint64_t, 2> lost{untold_deliveries_, untold_bytes_};
    push({FlightKind::lost, 0, 0, 0, read_ns}, lost.data(), sizeof lost);
    untold_deliveries_ = untold_bytes_ = 0;
  }
  push_state(channels, wall_shift_ns);
  auto flags = static_cast<std::uint8_t>((delivery.restarted || reopened_ ? kFlightReopened : 0) |
                                         (delivery.stamped ? kFlightStamped : 0));
  reopened_ = false;
  for (const ifog_can_frame& frame : delivery.frames) {
    push_frame(frame, flags, read_ns);
    flags &= static_cast<std::uint8_t>(~kFlightReopened);
  }
  if (delivery.bytes.empty() && !delivery.frames.empty()) return;
  const bool timed = delivery.arrival_ns != 0;
  push({FlightKind::bytes, static_cast<std::uint8_t>(flags | (timed ? 0 : kFlightReadTime)), 0, 0,
        timed ? delivery.arrival_ns : read_ns},
       delivery.bytes.data(), delivery.bytes.size());
}

bool Tape::take(FlightEntryHead& head, std::vector<std::uint8_t>& payload) {
  if (!begun_) {
    if (queue_.read_available() < kHead) return false;
    queue_.pop(reinterpret_cast<std::uint8_t*>(&begun_.emplace()), kHead);
  }
  if (queue_.read_available() < begun_->length) return false;
  payload.resize(begun_->length);
  if (begun_->length > 0) queue_.pop(payload.data(), payload.size());
  head = *begun_;
  begun_.reset();
  return true;
}

}  // namespace ifog

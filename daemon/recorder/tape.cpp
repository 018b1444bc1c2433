// SPDX-License-Identifier: Apache-2.0
#include "daemon/recorder/tape.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "drivers/transport/clock.h"

namespace ifog {
namespace {

constexpr std::size_t kHead = sizeof(FlightEntryHead);
constexpr std::size_t kFrameHead = 6;  // u32 id, u8 flags, u8 length
// In addition to FlightFlag, only on the tape.
constexpr std::uint8_t kBeginsDelivery = 128;
// Time without progress after which the recorder counts as blocked by its disk.
constexpr std::int64_t kAtWork_ns = 1'000'000'000;

std::size_t bytes_of(const Delivery& delivery) noexcept {
  std::size_t out = delivery.bytes.size();
  for (const ifog_can_frame& frame : delivery.frames) out += kFrameHead + frame.length;
  return out;
}

}  // namespace

// The queue's pages become resident; otherwise, without locked memory, the reader thread would have page faults
// until the tape has been used once.
Tape::Tape(std::size_t bytes) : bytes_(std::max(bytes, kLeastBytes)), queue_(bytes_) {
  const std::vector<std::uint8_t> zeros(1U << 16U);
  while (queue_.push(zeros.data(), zeros.size()) > 0) {
  }
  queue_.reset();
}

// Largest size of what put() may push for it.
std::size_t Tape::room_for(const Delivery& delivery) noexcept {
  return bytes_of(delivery) + (1 + delivery.frames.size()) * kHead +
         static_cast<std::size_t>(kMaxChannels + 2) * (kHead + 8) + kHead + (kHead + 16);
}

bool Tape::worth_waiting(const Delivery& delivery) const noexcept {
  const std::int64_t attended_ns = attended_ns_.load(std::memory_order_relaxed);
  const std::size_t room = room_for(delivery);
  return attended_ns != 0 && room <= bytes_ && queue_.write_available() < room &&
         monotonic_ns() - attended_ns < kAtWork_ns;
}

void Tape::attend(bool at_work) noexcept {
  attended_ns_.store(at_work ? monotonic_ns() : 0, std::memory_order_relaxed);
}

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
               std::int64_t wall_shift_ns, std::uint64_t merged) noexcept {
  const std::size_t bytes = bytes_of(delivery);
  counters_.deliveries.add(1);
  counters_.bytes.add(bytes);
  if (queue_.write_available() < room_for(delivery)) {
    counters_.lost_deliveries.add(1);
    counters_.lost_bytes.add(bytes);
    unreported_ += {1, bytes};
    reopened_ = reopened_ || delivery.restarted;
    return;
  }
  if (unreported_.deliveries > 0) {
    push({FlightKind::lost, 0, 0, 0, read_ns}, &unreported_, sizeof unreported_);
    unreported_ = {};
  }
  if (settings_due_ != 0) {
    const FlightEntryHead note{FlightKind::settings, 0, 0, std::exchange(settings_due_, 0), read_ns};
    queue_.push(reinterpret_cast<const std::uint8_t*>(&note), sizeof note);
  }
  push_state(channels, wall_shift_ns);
  if (merged != merged_) {
    const std::uint64_t since = merged - std::exchange(merged_, merged);
    push({FlightKind::merged, 0, 0, 0, read_ns}, &since, sizeof since);
  }
  auto flags = static_cast<std::uint8_t>((delivery.restarted || reopened_ ? kFlightReopened : 0) |
                                         (delivery.stamped ? kFlightStamped : 0));
  reopened_ = false;
  flags |= kBeginsDelivery;
  for (const ifog_can_frame& frame : delivery.frames) {
    push_frame(frame, flags, read_ns);
    flags &= static_cast<std::uint8_t>(~(kFlightReopened | kBeginsDelivery));
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
  const std::size_t length = begun_->kind == FlightKind::settings ? 0 : begun_->length;
  if (queue_.read_available() < length) return false;
  payload.resize(length);
  if (length > 0) queue_.pop(payload.data(), payload.size());
  head = *begun_;
  begins_delivery_ = (head.flags & kBeginsDelivery) != 0;
  head.flags &= static_cast<std::uint8_t>(~kBeginsDelivery);
  begun_.reset();
  return true;
}

}  // namespace ifog

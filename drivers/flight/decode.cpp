// SPDX-License-Identifier: Apache-2.0
#include "drivers/flight/decode.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

class Playback {
 public:
  Playback(DriverInstance& driver, const RecordedSamples& sink) : driver_(driver), sink_(sink) {}

  void begin(const FlightHeader& header) {
    const bool fits =
        header.carries == FlightHeader::Carries::can ? driver_.takes_can() : driver_.takes_bytes();
    if (!fits || header.carries == FlightHeader::Carries::messages)
      throw std::runtime_error("holds what driver \"" + std::string(driver_.table().name) +
                               "\" does not read, expected --driver with another");
    if (begun_ && (header.driver != first_.driver || header.sensor != first_.sensor ||
                   header.channels != first_.channels))
      throw std::runtime_error("continues with sensor " + in_quotes(header.sensor) + " of driver " +
                               in_quotes(header.driver) + " after sensor " + in_quotes(first_.sensor) +
                               " of driver " + in_quotes(first_.driver) +
                               " or with other channels, expected recordings of one");
    // Channels are unknown at the start of another run.
    if (!begun_ || header.run != run_) {
      outside_.assign(header.channels.size(), {});
      wall_shift_ns_ = 0;
    }
    run_ = header.run;
    if (std::exchange(begun_, true)) {
      if (sink_.file) sink_.file(header);
    } else {
      first_ = header;
    }
  }

  void miss() {
    if (sink_.missing) sink_.missing();
    interrupt();
  }

  void interrupt() {
    driver_.reset();
    sink_.discontinuity();
  }

  void take(const FlightEntry& entry) {
    if (entry.head.kind == FlightKind::channel) return take_channel(entry);
    if (entry.head.kind == FlightKind::wall) {
      entry.value(wall_shift_ns_);
      return;
    }
    if (std::uint64_t samples = 0; entry.head.kind == FlightKind::merged) {
      if (entry.value(samples) && sink_.merged) sink_.merged(samples);
      return;
    }
    if ((entry.head.flags & kFlightReopened) != 0) interrupt();
    const bool timed = (entry.head.flags & kFlightReadTime) == 0;
    const auto emit = [&](const ifog_sample& sample) {
      sink_.sample({sample, sample.arrival_ns != 0 ? sample.arrival_ns : entry.head.time_ns, outside_,
                    wall_shift_ns_});
    };
    ifog_can_frame frame{};
    if (entry.head.kind == FlightKind::bytes && driver_.takes_bytes())
      driver_.decode_bytes(entry.payload, timed ? entry.head.time_ns : 0, emit);
    else if (entry.head.kind == FlightKind::can && driver_.takes_can() && frame_of(entry, frame))
      driver_.decode_can(frame, emit);
  }

 private:
  void take_channel(const FlightEntry& entry) {
    double value = 0.0;
    if (entry.head.index < outside_.size() && entry.value(value))
      outside_[entry.head.index] = {value, entry.head.time_ns};
  }

  DriverInstance& driver_;
  const RecordedSamples& sink_;
  FlightHeader first_;
  std::uint64_t run_ = 0;
  bool begun_ = false;
  std::vector<ChannelValue> outside_;
  std::int64_t wall_shift_ns_ = 0;
};

}  // namespace

bool frame_of(const FlightEntry& entry, ifog_can_frame& frame) noexcept {
  constexpr std::size_t kFrameHead = 6;
  if (entry.head.kind != FlightKind::can || entry.payload.size() < kFrameHead) return false;
  frame = {};
  std::memcpy(&frame.id, entry.payload.data(), sizeof frame.id);
  frame.flags = entry.payload[4];
  frame.length = entry.payload[5];
  if (frame.length > sizeof frame.data || entry.payload.size() != kFrameHead + frame.length) return false;
  std::copy_n(entry.payload.data() + kFrameHead, frame.length, frame.data);
  frame.arrival_ns = (entry.head.flags & kFlightReadTime) != 0 ? 0 : entry.head.time_ns;
  return true;
}

void decode_flight(FlightReader& reader, DriverInstance& driver, const RecordedSamples& sink) {
  Playback playback(driver, sink);
  // The first header may have been read already.
  if (reader.counts().files > 0) playback.begin(reader.header());
  for (auto item = reader.next(); item != FlightReader::Item::end; item = reader.next()) {
    if (item == FlightReader::Item::header)
      playback.begin(reader.header());
    else if (item == FlightReader::Item::hole)
      playback.miss();
    else
      playback.take(reader.entry());
  }
}

}  // namespace ifog

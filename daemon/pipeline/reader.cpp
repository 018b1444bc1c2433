// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/reader.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

namespace ifog {
namespace {

constexpr auto kTurn = std::chrono::milliseconds(250);
// Timeout while increments wait outside a full ring, so that they do not wait for a silent source.
constexpr auto kImpatientTurn = std::chrono::milliseconds(1);
// Interval between checks for space on the tape.
constexpr auto kReaderPause = std::chrono::milliseconds(1);

}  // namespace

Reader::Reader(std::unique_ptr<Transport> transport, DriverInstance driver, const SensorFacts& facts,
               std::shared_ptr<const ChannelTable> outside, const ReaderLinks& links,
               SharedProcessors* processors)
    : transport_(std::move(transport)),
      driver_(std::move(driver)),
      facts_(facts),
      outside_(std::move(outside)),
      incrementer_(facts),
      links_(links),
      share_(processors) {}

void Reader::take(const ifog_sample& sample) noexcept {
  ++now_.decoded;
  read_sample(sample, facts_.frame_channels, reading_);
  reading_.arrival_recorded = transport_->times_are_recorded();
  reading_.read_ns = sample.arrival_ns != 0 ? sample.arrival_ns : turn_ns_;
  for (int i = facts_.frame_channels; i < facts_.channels; ++i) {
    const auto c = static_cast<std::size_t>(i);
    const ChannelValue& now = outside_now_[static_cast<std::size_t>(i - facts_.frame_channels)];
    reading_.channel[c] = now.value;
    reading_.channel_age_s[c] = now.age_s(reading_.read_ns);
  }
  const IncrementerCounts before = incrementer_.counts();
  Increment& increment = links_.queue.next();
  const bool complete = incrementer_.next(reading_, increment);
  now_.counts = incrementer_.counts();
  // Before the filter can have it: these accounts must include what the filter has received.
  links_.books.write(now_);
  if (!complete) return;
  report(increment, before);
  pushed_ += increment.samples;
  links_.queue.push();
}

void Reader::report(const Increment& increment, const IncrementerCounts& before) noexcept {
  const IncrementerCounts& now = incrementer_.counts();
  const auto tell = [&](EventKind kind, std::uint64_t count = 0, double a = 0.0) {
    links_.events.report({.kind = kind, .sequence = increment.sequence, .count = count, .a = a});
  };
  if (now.restarts != before.restarts)
    tell(EventKind::device_restart);
  else if (now.missing != before.missing)
    tell(EventKind::gap, now.missing - before.missing);
  if (now.clock_steps != before.clock_steps)
    tell(EventKind::clock_step, 0, static_cast<double>(increment.wall_shift_ns) * 1e-9);
  if (now.sensor_clock_sets != before.sensor_clock_sets) {
    const std::optional<double> refused = incrementer_.refused_clock();
    tell(refused ? EventKind::clock_refused : EventKind::sensor_clock_set, 0, refused.value_or(0.0));
  }
  if (now.pauses != before.pauses) tell(EventKind::label_moved);
  const std::uint64_t overflows = links_.queue.overflows();
  if (std::exchange(reported_.overflows, overflows) != overflows) tell(EventKind::overflow);
}

void Reader::tell_beyond(const ifog_driver_counters& driver) noexcept {
  Event event;
  event.kind = EventKind::beyond_stated;
  event.a = driver.beyond_value;
  event.b = driver.beyond_value > driver.beyond_maximum ? driver.beyond_maximum : driver.beyond_minimum;
  std::copy_n(driver.beyond_name, event.name.size(), event.name.begin());
  event.name.back() = '\0';
  links_.events.report(event);
}

void Reader::publish_books() {
  now_.axes_seen = incrementer_.axes_seen();
  now_.mixed = incrementer_.mixed() ? 1 : 0;
  now_.clock_offset_ppm = incrementer_.clock_offset_ppm();
  now_.interval_error = incrementer_.interval_error();
  now_.driver = driver_.counters();
  if (now_.driver.values_beyond != 0 && !std::exchange(reported_.beyond, true)) tell_beyond(now_.driver);
  if (outside_ != nullptr) {
    now_.channel_refused = outside_->refused();
    now_.channel_drops = outside_->drops();
  }
  now_.line = transport_->counters();
  links_.books.write(now_);
}

void Reader::look_outside() noexcept {
  for (int i = facts_.frame_channels; i < facts_.channels; ++i)
    outside_now_[static_cast<std::size_t>(i - facts_.frame_channels)] =
        outside_->latest(i - facts_.frame_channels);
}

void Reader::stand_back() noexcept {
  const std::int64_t rest_ns = share_.rest_ns(arrival_clock_ns(), thread_time_ns);
  if (rest_ns == 0) return;
  ++now_.stood_back;
  std::this_thread::sleep_for(std::chrono::nanoseconds(rest_ns));
}

void Reader::record(const Delivery& delivery) noexcept {
  // A source that buffers until it is read can wait for a working recorder.
  if (transport_->holds_back())
    while (!transport_->stopped() && links_.tape->worth_waiting(delivery))
      std::this_thread::sleep_for(kReaderPause);
  links_.tape->put(
      delivery, turn_ns_,
      std::span(outside_now_).first(static_cast<std::size_t>(facts_.channels - facts_.frame_channels)),
      reading_.wall_shift_ns, links_.queue.merged());
}

bool Reader::turn(std::chrono::nanoseconds timeout) {
  const Delivery delivery = transport_->read(timeout);
  if (delivery.restarted) {
    driver_.reset();
    incrementer_.discontinuity();
    links_.events.report({.kind = EventKind::reopened});
  }
  if (!delivery.empty() || delivery.restarted) {
    turn_ns_ = delivery.read_ns;
    // A recording at its own pace has its own times of day.
    if (!transport_->times_are_recorded()) reading_.wall_shift_ns = wall_shift_.at(turn_ns_);
    look_outside();
    const std::uint32_t settings = links_.exchange.mark(pushed_);
    if (settings != 0 && links_.tape != nullptr) links_.tape->note_settings(settings);
  }
  const auto sink = [this](const ifog_sample& sample) { take(sample); };
  if (!delivery.bytes.empty()) driver_.decode_bytes(delivery.bytes, delivery.arrival_ns, sink);
  for (const ifog_can_frame& frame : delivery.frames) driver_.decode_can(frame, sink);
  links_.hand_over.delivered();
  // After everything that is urgent.
  if (links_.tape != nullptr && (!delivery.empty() || delivery.restarted)) record(delivery);
  ++now_.turns;
  publish_books();
  // A source that waits for its reader takes no time from others.
  if (!transport_->holds_back()) stand_back();
  return !transport_->stopped() && !(delivery.empty() && transport_->state() == TransportState::ended);
}

void Reader::end() {
  transport_->close_books();
  // Bytes of an incomplete last frame count as skipped.
  const std::uint64_t skipped = driver_.counters().bytes_skipped;
  driver_.reset();
  if (!transport_->stopped()) now_.bytes_at_end = driver_.counters().bytes_skipped - skipped;
  publish_books();
}

void Reader::run() noexcept {
  const auto fail = [this](std::string_view thrown) {
    transport_->report("the driver has thrown an exception and is not called any more", 0,
                       std::string(driver_.table().name) + ": " + std::string(thrown));
    transport_->end(0);
  };
  try {
    while (turn(links_.queue.has_waiting() ? kImpatientTurn : kTurn)) {
    }
    end();
  } catch (const std::exception& error) {
    fail(error.what());
  } catch (...) {
    fail("of an unknown kind");
  }
  links_.queue.close();
}

}  // namespace ifog

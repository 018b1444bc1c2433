// SPDX-License-Identifier: Apache-2.0
// Stage 1 of a pipeline, the reader thread: transport → plugin → increments → queue.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "daemon/channels/channel_table.h"
#include "daemon/health/books.h"
#include "daemon/pipeline/event.h"
#include "daemon/pipeline/hand_over.h"
#include "daemon/pipeline/increment_queue.h"
#include "daemon/pipeline/parts_exchange.h"
#include "daemon/pipeline/processor_share.h"
#include "daemon/recorder/tape.h"
#include "daemon/sensor/facts.h"
#include "drivers/host/driver_instance.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/transport.h"
#include "filters/chain/incrementer.h"

namespace ifog {

// Links of the reader to the other parts of its pipeline.
struct ReaderLinks {
  IncrementQueue& queue;
  HandOver& hand_over;
  PartsExchange& exchange;
  SharedBooks& books;
  EventQueue& events;
  Tape* tape = nullptr;  // of the flight recorder, or null
};

class Reader {
 public:
  // processors: shared with other readers, or null.
  Reader(std::unique_ptr<Transport> transport, DriverInstance driver, const SensorFacts& facts,
         std::shared_ptr<const ChannelTable> outside, const ReaderLinks& links,
         SharedProcessors* processors = nullptr);

  // Runs until the transport is stopped or its file has ended, or the plugin throws, which ends the transport
  // with the fault. The caller opens it. Closes the queue.
  void run() noexcept;
  // One wait for the transport and its data. False: it has ended. Throws what the plugin throws.
  bool turn(std::chrono::nanoseconds timeout);

  [[nodiscard]] Transport& transport() noexcept { return *transport_; }
  [[nodiscard]] const Transport& transport() const noexcept { return *transport_; }
  [[nodiscard]] const DriverInstance& driver() const noexcept { return driver_; }
  // For any thread that may wait for the reader.
  [[nodiscard]] ReaderBooks books() const noexcept { return links_.books.read(); }

 private:
  void take(const ifog_sample& sample) noexcept;
  void look_outside() noexcept;
  void record(const Delivery& delivery) noexcept;
  void report(const Increment& increment, const IncrementerCounts& before) noexcept;
  void publish_books();
  void end();
  void tell_beyond(const ifog_driver_counters& driver) noexcept;
  void stand_back() noexcept;

  std::unique_ptr<Transport> transport_;
  DriverInstance driver_;
  SensorFacts facts_;
  std::shared_ptr<const ChannelTable> outside_;
  Incrementer incrementer_;
  ReaderLinks links_;
  Reading reading_;
  // External channels, constant for all samples of a delivery, as in the recording.
  std::array<ChannelValue, kMaxChannels> outside_now_;
  WallShift wall_shift_;
  ProcessorShare share_;
  std::int64_t turn_ns_ = 0;  // arrival clock, of the present turn
  struct Reported {
    std::uint64_t overflows = 0;
    bool beyond = false;
  } reported_;
  std::uint64_t pushed_ = 0;  // in samples
  ReaderBooks now_;
};

}  // namespace ifog

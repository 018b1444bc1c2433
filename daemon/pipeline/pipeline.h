// SPDX-License-Identifier: Apache-2.0
// One sensor: reader thread, filter thread and the queue between. Pipelines share only the account of their
// readers' processors.
#pragma once

#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "daemon/pipeline/filter_stage.h"
#include "daemon/pipeline/reader.h"
#include "daemon/realtime/realtime.h"

namespace ifog {

struct PipelinePlan {
  std::string lcm_channel;          // of rate_t
  std::vector<PublishedType> also;  // further types sent for each sample
  SensorFacts facts;
  std::size_t ring_slots = 1024;
  ThreadPlan reader, filter;
  bool spin = false;
  Tape* tape = nullptr;  // of the flight recorder, which must outlive the pipeline
  bool direct = true;    // the reader thread does an idle filter's step, see HandOver
  // Readers on those processors; null: the reader is the only one.
  std::shared_ptr<SharedProcessors> processors{};
};

class Pipeline {
 public:
  Pipeline(PipelinePlan plan, std::unique_ptr<Transport> transport, DriverInstance driver,
           std::shared_ptr<const ChannelTable> outside, std::unique_ptr<ChainParts> parts,
           std::unique_ptr<Publisher> publisher);
  ~Pipeline();  // stops

  // Sends the driver's opening bytes. Throws std::runtime_error as Transport::open; start() is possible
  // nevertheless, and the reader keeps trying.
  void open();
  // Starts both threads; returns the real-time settings that failed, or "". Throws std::system_error if no
  // thread is available; then nothing runs.
  std::string start();
  // Stops reading; publishes what was read. Waits for both threads.
  void stop() noexcept;
  // Both threads have ended (a file was read).
  [[nodiscard]] bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }

  [[nodiscard]] const PipelinePlan& plan() const noexcept { return plan_; }
  [[nodiscard]] const Reader& reader() const noexcept { return reader_; }
  [[nodiscard]] FilterStage& filter() noexcept { return filter_; }
  [[nodiscard]] const IncrementQueue& queue() const noexcept { return queue_; }
  [[nodiscard]] const HandOver& hand_over() const noexcept { return hand_over_; }
  // For one thread, once a second: "reader" or "filter" if that thread was ready but got no processor time
  // since the last call; else null.
  [[nodiscard]] const char* starved();
  // Next event of either thread.
  bool take_event(Event& out) noexcept { return reader_events_.take(out) || filter_events_.take(out); }
  [[nodiscard]] std::uint64_t events_lost() const noexcept {
    return reader_events_.lost() + filter_events_.lost();
  }

 private:
  PipelinePlan plan_;
  EventQueue reader_events_, filter_events_;
  SharedBooks reader_books_;
  IncrementQueue queue_;
  FilterStage filter_;
  HandOver hand_over_;
  Reader reader_;
  std::atomic<bool> ended_{false};
  ThreadWatch reader_watch_, filter_watch_;
  std::thread reader_thread_, filter_thread_;
};

}  // namespace ifog

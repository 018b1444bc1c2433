// SPDX-License-Identifier: Apache-2.0
// One sensor: its reader thread, its filter thread and the queue between them. Pipelines share nothing but
// the account of the processors that their readers run on.
#pragma once

#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "daemon/pipeline/filter_stage.h"
#include "daemon/pipeline/reader.h"
#include "daemon/realtime/realtime.h"
#include "daemon/realtime/thread_watch.h"

namespace ifog {

struct PipelinePlan {
  std::string lcm_channel;          // of rate_t
  std::vector<PublishedType> also;  // what is sent of each sample besides rate_t
  SensorFacts facts;
  std::size_t ring_slots = 1024;
  ThreadPlan reader, filter;
  bool spin = false;
  Tape* tape = nullptr;  // of the flight recorder, which outlives the pipeline
  bool direct = true;    // an idle filter's step is done by the reader thread, see HandOver
  // The readers of those processors; null: the reader is their only one.
  std::shared_ptr<SharedProcessors> processors{};
};

class Pipeline {
 public:
  Pipeline(PipelinePlan plan, std::unique_ptr<Transport> transport, DriverInstance driver,
           std::shared_ptr<const ChannelTable> outside, std::unique_ptr<ChainParts> parts,
           std::unique_ptr<Publisher> publisher);
  ~Pipeline();  // stops

  // Sends the driver's opening bytes. Throws std::runtime_error as Transport::open; start() may follow all
  // the same: the reader keeps trying.
  void open();
  // Starts both threads; returns what of their real-time settings could not be had, "" for nothing. Throws
  // std::system_error when the system has no thread left; nothing runs then.
  std::string start();
  // No more is read, what has been read is published. Waits for both threads.
  void stop() noexcept;
  // Both threads have come to their end (a file was read).
  [[nodiscard]] bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }

  [[nodiscard]] const PipelinePlan& plan() const noexcept { return plan_; }
  [[nodiscard]] const Reader& reader() const noexcept { return reader_; }
  [[nodiscard]] FilterStage& filter() noexcept { return filter_; }
  [[nodiscard]] const IncrementQueue& queue() const noexcept { return queue_; }
  [[nodiscard]] const HandOver& hand_over() const noexcept { return hand_over_; }
  // One thread, once a second: which of the two got no processor since this was asked last though it was
  // ready to run, "reader" or "filter"; null: neither.
  [[nodiscard]] const char* starved();
  // What the transport could not get and does without, once; "" for nothing new.
  std::string take_transport_warning() { return reader_.transport().notices().take_warning(); }
  // How the device has answered to its set-up, likewise.
  std::string take_transport_answers() { return reader_.transport().notices().take_answers(); }
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

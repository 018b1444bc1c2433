// SPDX-License-Identifier: Apache-2.0
// Stage 2 of a pipeline: queue → signal chain → encoder → publisher. Executed by the queue's present
// consumer: the filter thread, or the reader thread instead (HandOver).
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/health/books.h"
#include "daemon/health/rest_sums.h"
#include "daemon/pipeline/event.h"
#include "daemon/pipeline/increment_queue.h"
#include "daemon/pipeline/parts_exchange.h"
#include "daemon/pipeline/processor_share.h"
#include "daemon/publish/encoders.h"
#include "daemon/publish/publisher.h"
#include "daemon/sensor/duration_histogram.h"
#include "filters/allan/streaming.h"
#include "filters/chain/signal_chain.h"

namespace ifog {

// State of the filter for housekeeping, copied by the filter thread on request.
struct FilterSnapshot {
  // Channels are unknown before the first sample.
  FilterSnapshot() {
    channel.fill(std::numeric_limits<double>::quiet_NaN());
    channel_age_s.fill(std::numeric_limits<float>::infinity());
  }
  EstimatorHealth health;
  RestSums rest;
  std::optional<LearnedNoise> learned;  // ChainParts::learned()
  DurationHistogram latency;            // since the previous snapshot
  std::array<double, kMaxChannels> channel;
  std::array<float, kMaxChannels> channel_age_s;
  std::array<char, 64> model{};
  std::int64_t model_since_ns = 0;  // utime of the first sample with it; 0: none
  // One consistent moment: the difference is in the ring.
  ReaderBooks reader;
  FilterBooks books;
  // Allan deviation of the compensated rate at 2^k samples since start-up, including motion.
  double allan_period_s = 0.0;
  int allan_octaves = 0;
  std::array<std::array<double, StreamingAllan::kOctaves>, kMaxAxes> allan_radps{};
};

class FilterStage {
 public:
  // measure_latency: false if arrival times are not present ones (a log). also: further types sent for each
  // sample.
  FilterStage(std::unique_ptr<ChainParts> parts, const SensorFacts& facts, std::string channel,
              const std::vector<PublishedType>& also, std::unique_ptr<Publisher> publisher,
              IncrementQueue& queue, const SharedBooks& reader_books, EventQueue& events,
              bool measure_latency);

  // Runs until the queue is closed and empty. spin: never sleeps, for a spare processor.
  void run(bool spin) noexcept;
  // For the queue's consumer: processes the oldest increment. False: the queue is empty.
  bool step() noexcept;

  // For any one other thread: new parts, used from the next delivery on, replacing unused earlier offers.
  // number: of their settings, for recordings.
  void offer(std::unique_ptr<ChainParts> parts, std::uint32_t number = 1) {
    exchange_.offer(std::move(parts), number);
  }
  // Frees unused parts.
  void collect_retired() noexcept { exchange_.collect_retired(); }
  // The reader's interface to it.
  [[nodiscard]] PartsExchange& exchange() noexcept { return exchange_; }
  // Requests a snapshot. False: the last one is not ready yet. After the end of run() there is one at every
  // call, without request.
  bool ask() noexcept;
  // True: `out` has the requested snapshot.
  bool take_snapshot(FilterSnapshot& out) noexcept;

 private:
  enum class Ask : std::uint32_t { none, asked, answered };
  void process(const Increment& in) noexcept;
  void stand_back(std::int64_t slept_ns) noexcept;
  void adopted(std::uint64_t sequence) noexcept;
  void follow_noise(const Increment& in) noexcept;
  bool answer() noexcept;

  SensorFacts facts_;
  SignalChain chain_;
  struct Also {
    std::string channel;
    std::unique_ptr<InertialEncoder> encoder;
  };
  struct Output {
    std::string channel;
    RateEncoder encoder;
    std::vector<Also> also;
    std::unique_ptr<Publisher> publisher;
  } output_;
  IncrementQueue& queue_;
  const SharedBooks& reader_books_;
  EventQueue& events_;
  bool measure_latency_;
  bool noise_known_;
  ChainOutput out_;
  // A sample clock may be off by per cents, so averaging times use measured intervals.
  struct Intervals {
    std::array<StreamingAllan, kMaxAxes> allan;
    std::uint64_t count = 0;
    double mean_s = 0.0;
  } intervals_;
  struct Answer {
    FilterSnapshot now;    // filled with each sample
    FilterSnapshot given;  // belongs to housekeeping while the state is `answered`
    std::atomic<Ask> state{Ask::none};
    std::atomic<bool> finished{false};  // the last sample was processed
  } answer_;
  PartsExchange exchange_;
  ProcessorShare share_;
  std::int64_t rested_ns_ = 0;
};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/pipeline.h"

#include <span>
#include <system_error>
#include <utility>

namespace ifog {

Pipeline::Pipeline(PipelinePlan plan, std::unique_ptr<Transport> transport, DriverInstance driver,
                   std::shared_ptr<const ChannelTable> outside, std::unique_ptr<ChainParts> parts,
                   std::unique_ptr<Publisher> publisher)
    : plan_(std::move(plan)),
      queue_(plan_.ring_slots,
             transport->holds_back() ? IncrementQueue::WhenFull::wait : IncrementQueue::WhenFull::merge),
      filter_(std::move(parts), plan_.facts, plan_.lcm_channel, plan_.also, std::move(publisher), queue_,
              reader_books_, filter_events_, !transport->holds_back()),
      hand_over_(queue_, filter_, plan_.facts.nominal_rate_hz, plan_.direct && !plan_.spin),
      reader_(std::move(transport), std::move(driver), plan_.facts, std::move(outside),
              {queue_, hand_over_, filter_.exchange(), reader_books_, reader_events_, plan_.tape},
              plan_.processors.get()) {}

Pipeline::~Pipeline() { stop(); }

void Pipeline::open() {
  const ifog_description& description = reader_.driver().description();
  reader_.transport().open(std::span(description.opening, description.opening_length));
}

std::string Pipeline::start() {
  std::promise<std::string> filter_ready, reader_ready;
  const auto prepare = [](const ThreadPlan& plan, ThreadWatch& watch, std::promise<std::string>& ready) {
    watch.begin();
    prefault_stack();
    ready.set_value(apply_to_this_thread(plan));
  };
  filter_thread_ = std::thread([this, &filter_ready, prepare] {
    prepare(plan_.filter, filter_watch_, filter_ready);
    filter_.run(plan_.spin);
    ended_.store(true, std::memory_order_release);
  });
  std::string missed = filter_ready.get_future().get();
  try {
    reader_thread_ = std::thread([this, &reader_ready, prepare] {
      prepare(plan_.reader, reader_watch_, reader_ready);
      reader_.run();
    });
  } catch (const std::system_error&) {
    // Otherwise the filter thread would wait forever.
    queue_.close();
    filter_thread_.join();
    throw;
  }
  const std::string reader_missed = reader_ready.get_future().get();
  if (!missed.empty() && !reader_missed.empty()) missed += "; ";
  return missed + reader_missed;
}

const char* Pipeline::starved() {
  const bool reader = reader_watch_.starved(), filter = filter_watch_.starved();
  return reader ? "reader" : filter ? "filter" : nullptr;
}

void Pipeline::stop() noexcept {
  reader_.transport().stop();
  if (reader_thread_.joinable()) reader_thread_.join();
  if (filter_thread_.joinable()) filter_thread_.join();
}

}  // namespace ifog

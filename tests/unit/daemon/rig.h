// SPDX-License-Identifier: Apache-2.0
// Whole pipelines, from bytes to encoded messages: two real threads, the real plugin, a publisher that keeps
// all.
#pragma once

#include <ifog/decode.h>
#include <ifog/rate_t.hpp>

#include "daemon/housekeeping/status_report.h"
#include "daemon/pipeline/pipeline.h"
#include "tests/unit/daemon/chain_behind.h"
#include "tests/unit/daemon/kvh_frames.h"
#include "tests/unit/test.h"

namespace ifog {

inline constexpr std::int64_t kBegin_ns = 1'000'000'000'000;  // arrival of the first

// Hands out what it was given, in portions, as fast as it is asked.
class MemoryTransport final : public Transport {
 public:
  MemoryTransport(std::vector<std::uint8_t> bytes, std::size_t portion, bool holds_back)
      : Transport("memory"), bytes_to_give_(std::move(bytes)), portion_(portion), holds_back_(holds_back) {}
  bool connect(std::string&, std::int64_t) override { return true; }
  Delivery receive(std::int64_t) noexcept override {
    Delivery out;
    if (stray_.exchange(false)) report("a stray", 0);
    const bool all_given = at_ >= bytes_to_give_.size();
    if (all_given && !stays_open_.load()) end(0);
    if (all_given || at_ >= allowed_.load()) {
      if (state() != TransportState::ended) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return out;
    }
    const std::size_t n = std::min(portion_, bytes_to_give_.size() - at_);
    out.bytes = std::span(bytes_to_give_).subspan(at_, n);
    // As of a device that sends 1000 frames a second, whenever the threads of the test get their turn: one
    // that is delayed is no gap.
    out.arrival_ns = kBegin_ns + static_cast<std::int64_t>(at_ / kFrame) * 1'000'000;
    at_ += n;
    given_.store(at_);
    return out;
  }
  [[nodiscard]] bool holds_back() const override { return holds_back_; }

 private:
  std::vector<std::uint8_t> bytes_to_give_;
  std::size_t portion_, at_ = 0;
  bool holds_back_;

 public:
  std::atomic<std::size_t> given_{0};
  std::atomic<std::size_t> allowed_{~std::size_t{0}};  // no more than this is given yet
  std::atomic<bool> stays_open_{false};
  std::atomic<bool> stray_{false};  // at first a fault in the data is reported
};

class KeepingPublisher final : public Publisher {
 public:
  explicit KeepingPublisher(std::chrono::microseconds pause = std::chrono::microseconds(0)) : pause_(pause) {}
  bool publish(const char* channel, std::span<const std::uint8_t> message) noexcept override {
    if (std::string_view(channel) == "IFOG_TEST_IMU") {
      imu_t increment{};
      const bool whole = decode_message(message, increment);
      const std::lock_guard lock(mutex_);
      if (const int n = imu_messages_++; n >= imu_refused_from && n < imu_refused_to) return false;
      if (whole) increments_.push_back(increment);
      return whole;
    }
    rate_t decoded{};
    const bool good = decoded.decode(message.data(), 0, static_cast<int>(message.size())) > 0;
    const std::lock_guard lock(mutex_);
    if (good && std::string(channel) == "IFOG_TEST") messages_.push_back(decoded);
    if (pause_ > std::chrono::microseconds(0)) std::this_thread::sleep_for(pause_);
    return good;
  }
  std::vector<rate_t> messages() {
    const std::lock_guard lock(mutex_);
    return messages_;
  }
  std::vector<imu_t> increments() {
    const std::lock_guard lock(mutex_);
    return increments_;
  }

  // Messages of imu_t, by their number, that LCM does not take. Before the start.
  int imu_refused_from = 0, imu_refused_to = 0;

 private:
  std::chrono::microseconds pause_;
  std::mutex mutex_;
  int imu_messages_ = 0;
  std::vector<rate_t> messages_;
  std::vector<imu_t> increments_;
};

inline double rate_of(int n) { return 0.01 + 1e-4 * std::sin(0.01 * n); }

inline double temperature_of(int n) { return n % 50; }

inline std::vector<std::uint8_t> frames(int count, const std::function<double(int)>& disturbed = {}) {
  return kvh_frames(
      0, count, [&](int n) { return rate_of(n) + (disturbed ? disturbed(n) : 0.0); }, temperature_of);
}

// A pipeline of a KVH 1750 at 1 kHz, its noise given.
struct Rig {
  Rig(std::unique_ptr<Transport> from, std::unique_ptr<Publisher> to, PipelinePlan plan)
      : transport(dynamic_cast<MemoryTransport*>(from.get())),
        publisher(dynamic_cast<KeepingPublisher*>(to.get())) {
    DriverInstance driver = make_driver("kvh1750", {});
    chain = chain_behind(driver, 1000.0);
    plan.lcm_channel = "IFOG_TEST";
    plan.facts = chain.facts;
    plan.reader.name = "read";
    plan.filter.name = "filter";
    pipeline = std::make_unique<Pipeline>(plan, std::move(from), std::move(driver), nullptr,
                                          std::make_unique<ChainParts>(chain), std::move(to));
    report = std::make_unique<StatusReport>("test", chain.channels, chain.axes, chain.facts.nominal_rate_hz);
    pipeline->open();
  }
  Rig(std::vector<std::uint8_t> bytes, std::size_t portion, bool holds_back, std::size_t slots = 1024,
      std::chrono::microseconds pause = std::chrono::microseconds(0), bool direct = true,
      Tape* tape = nullptr)
      : Rig(std::make_unique<MemoryTransport>(std::move(bytes), portion, holds_back),
            std::make_unique<KeepingPublisher>(pause), [&] {
              PipelinePlan plan;
              plan.also = {{std::string(kImuType), "IFOG_TEST_IMU"}};
              plan.ring_slots = slots;
              plan.direct = direct;
              plan.tape = tape;
              return plan;
            }()) {}
  void run_to_the_end() {
    pipeline->start();
    wait_for_the_end();
  }
  // One frame at a time until the reader has found the filter thread asleep, then the rest.
  void run_from_rest_to_the_end() {
    transport->allowed_ = 0;
    pipeline->start();
    while (pipeline->hand_over().done_here() == 0) {
      transport->allowed_ += kFrame;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    transport->allowed_ = ~std::size_t{0};
    wait_for_the_end();
  }
  // What housekeeping would be told now.
  FilterSnapshot snapshot() {
    pipeline->filter().ask();
    FilterSnapshot out;
    while (!pipeline->filter().take_snapshot(out)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return out;
  }
  // Its status message of this second.
  const status_t& status(const FilterSnapshot& now) { return report->update(*pipeline, now, 1.0); }
  void await_messages(std::size_t count) {
    while (publisher->messages().size() < count) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  void wait_for_the_end() {
    while (!pipeline->ended()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    pipeline->stop();
  }
  ChainSettings chain;
  MemoryTransport* transport;  // nullptr: another one
  KeepingPublisher* publisher;
  std::unique_ptr<Pipeline> pipeline;
  std::unique_ptr<StatusReport> report;
};

inline double sent_angle(int count) {
  double sum = 0.0;
  for (int n = 0; n < count; ++n) sum += static_cast<double>(static_cast<float>(rate_of(n))) * 1e-3;
  return sum;
}

}  // namespace ifog

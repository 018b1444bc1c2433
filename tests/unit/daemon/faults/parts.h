// SPDX-License-Identifier: Apache-2.0
// The ends of a pipeline that are beset with faults: the line, the bus of a channel, the network.
#pragma once

#include <atomic>
#include <cstdint>
#include <ifog/rate_t.hpp>
#include <mutex>
#include <random>
#include <set>
#include <vector>

#include "daemon/publish/publisher.h"
#include "drivers/transport/transport.h"
#include "tests/unit/daemon/faults/wire.h"

namespace ifog {

// Gives what the wire carries in portions of any size; at each of `cuts` its writer goes, or the device does,
// as a cable that is pulled or an interface that is set down, and may refuse to be opened for a while. The
// kernel drops some beside, and tells of the last ones only when it is asked.
class FaultyTransport final : public Transport {
 public:
  FaultyTransport(const Wire& wire, std::vector<std::size_t> cuts, unsigned seed, bool holds_back);
  bool connect(std::string& warning, std::int64_t until_ns) override;
  Delivery receive(std::int64_t until_ns) noexcept override;
  void count_losses() noexcept override;
  [[nodiscard]] bool holds_back() const override { return holds_back_; }

  // Any thread.
  [[nodiscard]] std::size_t given() const { return given_.load(std::memory_order_acquire); }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_.load(); }

 private:
  std::uint64_t below(std::uint64_t n) {
    return std::uniform_int_distribution<std::uint64_t>(0, n - 1)(random_);
  }
  void cut() noexcept;

  const Wire& wire_;
  std::vector<std::size_t> cuts_;
  std::mt19937 random_;
  bool holds_back_;
  std::size_t at_ = 0, next_cut_ = 0;
  std::uint64_t refusals_ = 0, untold_ = 0;
  std::atomic<std::size_t> given_{0};
  std::atomic<std::uint64_t> dropped_{0};
};

// A channel's bus that never falls silent: good temperatures, some that cannot be, NaN, frames of others.
class FloodedBus final : public Transport {
 public:
  FloodedBus(unsigned seed, std::atomic<std::uint64_t>& dropped);
  bool connect(std::string&, std::int64_t) override { return true; }
  Delivery receive(std::int64_t until_ns) noexcept override;
  static constexpr double kLeast_degC = 20.0, kMost_degC = 30.0;  // of those that can be

 private:
  std::mt19937 random_;
  std::atomic<std::uint64_t>& dropped_;
  std::vector<ifog_can_frame> frames_;
};

// Takes messages, at times slowly, and refuses some.
class FaultyPublisher final : public Publisher {
 public:
  FaultyPublisher(unsigned seed, bool slow) : random_(seed), slow_(slow) {}
  bool publish(const char* channel, std::span<const std::uint8_t> message) noexcept override;

  // Of the last message, also of one that was not taken; 0 before the first.
  [[nodiscard]] double angle() const;
  [[nodiscard]] std::uint64_t taken() const;
  [[nodiscard]] bool all_readable() const;
  // Distances of the messages' times of day from when they arrived, s, in steps of a minute.
  [[nodiscard]] std::set<std::int64_t> label_shifts_min() const;

 private:
  mutable std::mutex mutex_;
  std::mt19937 random_;
  bool slow_, readable_ = true;
  rate_t last_{};
  std::uint64_t taken_ = 0;
  std::set<std::int64_t> shifts_min_;
};

}  // namespace ifog

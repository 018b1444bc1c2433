// Values of environment channels that do not come in the sensor's own frames. Written by whoever listens to
// their source, read by the sensor's reader thread at every sample.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>

namespace ifog {

class ChannelTable {
 public:
  explicit ChannelTable(int channels)
      : entries_(std::make_unique<Entry[]>(static_cast<std::size_t>(channels))) {}

  // One writer a channel.
  void set(int channel, double value, std::int64_t time_ns) noexcept {
    Entry& entry = entries_[static_cast<std::size_t>(channel)];
    entry.value.store(value, std::memory_order_relaxed);
    entry.time_ns.store(time_ns, std::memory_order_release);
  }
  // A value came that cannot be: the one before stays, and grows old.
  void refuse() noexcept { refused_.fetch_add(1, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }
  // So many messages of a source of these channels were lost before they could be read.
  void lose(std::uint64_t messages) noexcept { drops_.fetch_add(messages, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t drops() const noexcept { return drops_.load(std::memory_order_relaxed); }

  // NaN and an infinite age until the first value. The value is at least as new as the age says: updates that
  // come between the two loads show in the value alone.
  void get(int channel, std::int64_t now_ns, double& value, float& age_s) const noexcept {
    const Entry& entry = entries_[static_cast<std::size_t>(channel)];
    const std::int64_t time_ns = entry.time_ns.load(std::memory_order_acquire);
    value = entry.value.load(std::memory_order_relaxed);
    age_s =
        time_ns == 0 ? std::numeric_limits<float>::infinity() : static_cast<float>(now_ns - time_ns) * 1e-9F;
    if (age_s < 0.0F) age_s = 0.0F;
  }

 private:
  struct Entry {
    std::atomic<double> value{std::numeric_limits<double>::quiet_NaN()};
    std::atomic<std::int64_t> time_ns{0};
  };
  std::unique_ptr<Entry[]> entries_;
  std::atomic<std::uint64_t> refused_{0}, drops_{0};
};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// Source of a sensor's reader thread: serial line, CAN interface, network or file.
//
// Threads: open() and read() belong to the reader thread. stop(), stopped(), state(), reason(), counters(),
// fault() and notices() may be called from any thread, stop() also from a signal handler.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/ifog/driver.h"
#include "drivers/transport/counter.h"
#include "drivers/transport/stoppable_wait.h"

namespace ifog {

// Data of one read(). Refers to the transport: valid until the next read().
struct Delivery {
  std::span<const std::uint8_t> bytes;  // of a byte transport
  // Arrival of the last of `bytes`; 0: unknown, because this process was delayed and read late.
  std::int64_t arrival_ns = 0;
  std::int64_t read_ns = 0;                // time of the read, arrival clock
  bool stamped = false;                    // by the kernel: arrival_ns is right even after a late read
  std::span<const ifog_can_frame> frames;  // of a CAN transport; each frame has its own time
  bool restarted = false;                  // the first since the device was reopened: discard partial frames

  [[nodiscard]] bool empty() const { return bytes.empty() && frames.empty(); }
};

// A wanted CAN frame.
struct CanId {
  std::uint32_t id = 0;
  bool extended = false;

  bool operator==(const CanId&) const = default;
};

// A device cannot be opened: one line with the device, the system's reason and what was expected.
struct OpenError : std::runtime_error {
  OpenError(const std::string& device, const std::string& what, int error, const std::string& expected);
  int reason;  // errno
};

enum class TransportState {
  open,
  gone,   // the device disappeared, or open() failed: read() keeps trying
  ended,  // end of a file, or a read error (reason() is not 0): no more data
};

// Counters only grow.
struct TransportCounters {
  std::uint64_t bytes = 0;         // delivered
  std::uint64_t frames = 0;        // delivered, CAN
  std::uint64_t kernel_drops = 0;  // frames, datagrams or bytes dropped by the kernel
  std::uint64_t error_frames = 0;  // CAN error frames; damaged serial bytes, overruns, breaks
  std::uint64_t reopened = 0;      // number of reopenings
  std::uint64_t malformed = 0;     // invalid lines of a log, a truncated file, datagrams
                                   // from other senders; see fault()
};

// Latest kind of fault in the data and its first position, for the log: "PATH:LINE: WHAT".
struct TransportFault {
  const char* what = nullptr;  // static text; nullptr: none
  std::uint64_t line = 0;      // 0: not line-based
  std::string_view text{};     // beginning of the text there; lives as long as the transport
};

// Messages from opening a device, for the log. Thread-safe; the mutex is used when a device opens, never
// while it is read.
class Notices {
 public:
  // What the device did not grant but is not essential; "" for nothing.
  void keep_warning(std::string&& warning) {
    const std::lock_guard lock(mutex_);
    new_warning_ = new_warning_ || (!warning.empty() && warning != warning_);
    warning_ = std::move(warning);
  }
  // Returns each text once, even if the device is reopened with the same; "" if there is nothing new.
  [[nodiscard]] std::string take_warning() {
    const std::lock_guard lock(mutex_);
    return std::exchange(new_warning_, false) ? warning_ : std::string();
  }
  // The device's answers to its set-up.
  void keep_answers(const std::string& answers) {
    const std::lock_guard lock(mutex_);
    answers_ = answers;
  }
  // Returns them once each time; "" if there is nothing new.
  [[nodiscard]] std::string take_answers() {
    const std::lock_guard lock(mutex_);
    return std::exchange(answers_, {});
  }

 private:
  std::mutex mutex_;
  std::string warning_, answers_;
  bool new_warning_ = false;
};

// Decides if the time of a read is an arrival time.
//
// A process that was delayed (stopped, starved, asleep with its computer) reads everything that arrived
// meanwhile at once. If the read time were used as arrival time, late reads would look like a silence, and
// later samples like losses. So after a read that was entered or left late, arrival times are unknown until
// the backlog is read.
class Backlog {
 public:
  // Reports one read: entry, end and timeout. True: its data may have arrived at any time.
  bool read(std::int64_t entered_ns, std::int64_t left_ns, std::int64_t timeout_ns) noexcept {
    const bool late = left_ns - entered_ns > timeout_ns + kDelayed_ns ||
                      (left_ns_ != 0 && entered_ns - left_ns_ > kDelayed_ns);
    left_ns_ = left_ns;
    if (late) until_ns_ = left_ns + kPiled_ns;
    return until_ns_ != 0;
  }
  // True if the backlog may be read completely, provided that nothing more waits.
  [[nodiscard]] bool may_be_over() const noexcept { return left_ns_ > until_ns_; }
  void over() noexcept { until_ns_ = 0; }

 private:
  static constexpr std::int64_t kDelayed_ns = 50'000'000;
  // The kernel passes data between buffers, so an empty read soon after the first is not conclusive.
  static constexpr std::int64_t kPiled_ns = 100'000'000;
  std::int64_t left_ns_ = 0, until_ns_ = 0;
};

class Transport {
 public:
  // Throws std::runtime_error if no eventfd is available.
  explicit Transport(std::string name) : name_(std::move(name)) {}
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  // `opening` is sent whenever the device opens. Throws OpenError; then the transport is `gone`, and read()
  // waits for the device.
  void open(std::span<const std::uint8_t> opening);

  // Waits until data arrive, `timeout` has passed or stop() is called; returns the data, possibly empty.
  // Never throws; does not allocate while the device is open.
  Delivery read(std::chrono::nanoseconds timeout) noexcept;

  // To be called after the last read(): counts the kernel's last drops.
  void close_books() noexcept {
    if (link_.open) count_losses();
  }

  // True: the source buffers until it is read, so a reader whose ring is full may stop reading without
  // losses.
  [[nodiscard]] virtual bool holds_back() const { return false; }
  // True: arrival times are from a recording, possibly of another day.
  [[nodiscard]] virtual bool times_are_recorded() const { return false; }

  // Ends the present read() and all later ones.
  void stop() noexcept { waiting_.stop(); }
  [[nodiscard]] bool stopped() const { return waiting_.stopped(); }

  [[nodiscard]] const std::string& name() const { return name_; }
  // A state is published after its reason: errno of the latest failure.
  [[nodiscard]] TransportState state() const { return state_.load(std::memory_order_acquire); }
  [[nodiscard]] int reason() const { return reason_.load(std::memory_order_relaxed); }
  [[nodiscard]] TransportCounters counters() const;
  [[nodiscard]] TransportFault fault() const;
  // Messages from opening the device.
  [[nodiscard]] Notices& notices() const { return notices_; }
  // No more data: of the reading thread.
  void end(int reason) noexcept { enter(TransportState::ended, reason); }
  // A fault in the data, also counted as malformed. text: of the line. Of the reading thread.
  void report(const char* what, std::uint64_t line, std::string_view text = {}) noexcept;

 protected:
  using Wake = StoppableWait::Wake;

  // (Re)opens the device and sends opening(). False: no answer until `until_ns` of CLOCK_MONOTONIC or stop();
  // the next call continues. Throws OpenError.
  virtual bool connect(std::string& warning, std::int64_t until_ns) = 0;
  // read() of an open device, until `until_ns` of CLOCK_MONOTONIC. Calls lost(), left() or end() when the
  // data end.
  virtual Delivery receive(std::int64_t until_ns) noexcept = 0;
  // Updates the counters of kernel drops and error frames.
  virtual void count_losses() noexcept {}
  // True if receive() would return data at once.
  [[nodiscard]] virtual bool more_waits() noexcept { return false; }

  [[nodiscard]] std::span<const std::uint8_t> opening() const { return opening_; }
  // The device disappeared: connect() will be tried again.
  void lost(int reason) noexcept;
  // It is open, but without a sender until the next delivery.
  void left() noexcept;

  struct Counters {
    Counter bytes, frames, kernel_drops, error_frames, reopened, malformed;
  } counters_;
  StoppableWait waiting_;

 private:
  bool regain(std::int64_t until_ns) noexcept;
  void failed() noexcept;
  void enter(TransportState state, int reason) noexcept;

  // Reopened at once, then at growing intervals, so that a returning device is used within a second.
  static constexpr std::int64_t kFirstPause_ns = 10'000'000, kLongestPause_ns = 100'000'000;
  struct Link {
    std::int64_t since_ns = 0;    // open, of CLOCK_MONOTONIC
    std::int64_t attempt_ns = 0;  // next one to open it, of the same clock
    std::int64_t pause_ns = kFirstPause_ns;
    bool open = false, once = false;
    bool returning = false;  // the next delivery is the first since the device was reopened
  };
  // First fault of each kind, written once before it is published.
  struct KindOfFault {
    TransportFault fault;
    std::array<char, 60> text{};
  };
  struct Faults {
    std::array<KindOfFault, 6> kinds{};
    std::atomic<const TransportFault*> latest{nullptr};
  };

  std::string name_;
  std::vector<std::uint8_t> opening_;
  mutable Notices notices_;
  Link link_;
  Backlog backlog_;
  // Relaxed: independent values. A reader may see a state before its reason, which is only for messages.
  std::atomic<TransportState> state_{TransportState::gone};
  std::atomic<int> reason_{0};
  Faults faults_;
};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// What a sensor's reader thread reads from: a serial line, a CAN interface, the network or a file, behind one
// interface.
//
// Threads: open() and read() belong to the reader thread. stop(), stopped(), state(), reason(), counters(),
// fault() and notices() may be called from any thread, stop() also from a signal handler.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/ifog/driver.h"
#include "drivers/transport/backlog.h"
#include "drivers/transport/backoff.h"
#include "drivers/transport/counter.h"
#include "drivers/transport/notices.h"
#include "drivers/transport/stoppable_wait.h"

namespace ifog {

// What one read() brought. Points into the transport: valid until the next read().
struct Delivery {
  std::span<const std::uint8_t> bytes;  // a byte transport
  // Arrival of the last of `bytes`; 0: not known, because this process was delayed and read late what
  // may have come at any time since.
  std::int64_t arrival_ns = 0;
  std::int64_t read_ns = 0;                // when it was read, arrival clock
  bool stamped = false;                    // by the kernel: arrival_ns is right however late it was read
  std::span<const ifog_can_frame> frames;  // a CAN transport; each frame has its own time
  bool restarted = false;  // the first since the device was opened again: forget half-read frames

  [[nodiscard]] bool empty() const { return bytes.empty() && frames.empty(); }
};

// A CAN frame that a sensor wants.
struct CanId {
  std::uint32_t id = 0;
  bool extended = false;
};

// A device that cannot be opened: one line with the device, the system's reason and what was expected.
struct OpenError : std::runtime_error {
  OpenError(const std::string& device, const std::string& what, int error, const std::string& expected);
  int reason;  // errno
};

enum class TransportState {
  open,
  gone,   // the device went away, or open() failed: read() keeps trying to get it back
  ended,  // a file is at its end, or cannot be read any further (reason() is not 0): nothing more will come
};

// Counters only grow.
struct TransportCounters {
  std::uint64_t bytes = 0;         // delivered
  std::uint64_t frames = 0;        // delivered, CAN
  std::uint64_t kernel_drops = 0;  // frames, datagrams or bytes the kernel had no room for
  std::uint64_t error_frames = 0;  // CAN error frames; damaged serial bytes, overruns, breaks
  std::uint64_t reopened = 0;      // times the device came back
  std::uint64_t malformed = 0;  // lines of a log that are no frame, a file cut off in the middle, datagrams
                                // from somebody else; see fault()
};

// The latest kind of fault in what was read, where it first was, which is where to begin to look; for one
// line in the log: "PATH:LINE: WHAT".
struct TransportFault {
  const char* what = nullptr;  // static text; nullptr: none so far
  std::uint64_t line = 0;      // 0: not a matter of lines
  std::string_view text{};     // what stands there, its beginning; lives as long as the transport
};

class Transport {
 public:
  // Throws std::runtime_error when the system has no eventfd left.
  explicit Transport(std::string name) : name_(std::move(name)) {}
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  // `opening` is sent each time the device opens. Throws OpenError. The transport is then `gone`: whoever
  // wants to wait for a device that is absent continues with read().
  void open(std::span<const std::uint8_t> opening);

  // Waits until something arrives, `timeout` has passed or stop() is called, and returns what is there, empty
  // for nothing. Never throws and, while the device is open, never allocates.
  Delivery read(std::chrono::nanoseconds timeout) noexcept;

  // After the last read(): counts what the kernel has still to say of bytes and frames it had no room for.
  void close_books() noexcept {
    if (link_.open) count_losses();
  }

  // True: the source keeps until it is read, so a reader whose ring is full stops reading rather than lose
  // samples.
  [[nodiscard]] virtual bool holds_back() const { return false; }
  // True: arrival times are those of a recording, times of day of another day included.
  [[nodiscard]] virtual bool times_are_recorded() const { return false; }

  // Ends a waiting read() at once and every later one immediately.
  void stop() noexcept { waiting_.stop(); }
  [[nodiscard]] bool stopped() const { return waiting_.stopped(); }

  [[nodiscard]] const std::string& name() const { return name_; }
  // Whoever sees a state sees its reason, too: errno of the latest failure.
  [[nodiscard]] TransportState state() const { return state_.load(std::memory_order_acquire); }
  [[nodiscard]] int reason() const { return reason_.load(std::memory_order_relaxed); }
  [[nodiscard]] TransportCounters counters() const;
  [[nodiscard]] TransportFault fault() const;
  // What opening the device, for the first time or again, said.
  [[nodiscard]] Notices& notices() { return notices_; }

 protected:
  using Wake = StoppableWait::Wake;
  using Received = StoppableWait::Received;

  // Opens the device, again if need be, and sends opening(). False: the other end has not answered when
  // `until_ns` of CLOCK_MONOTONIC has passed or stop() was called; the next call waits on. Throws OpenError.
  virtual bool connect(std::string& warning, std::int64_t until_ns) = 0;
  // read() of an open device, until `until_ns` of CLOCK_MONOTONIC. Calls lost(), left() or end() when there
  // is no more.
  virtual Delivery receive(std::int64_t until_ns) noexcept = 0;
  // Brings the counters of kernel drops and error frames up to what the kernel has counted against the open device.
  virtual void count_losses() noexcept {}
  // Whether receive() would find something at once.
  [[nodiscard]] virtual bool more_waits() noexcept { return false; }

  [[nodiscard]] std::span<const std::uint8_t> opening() const { return opening_; }
  // The device went away: connect() will be tried again.
  void lost(int reason) noexcept;
  // It is open but nobody is at its other end until the next delivery.
  void left() noexcept;
  void end(int reason) noexcept { enter(TransportState::ended, reason); }

  // Counts it as malformed, too. text: the line's.
  void report(const char* what, std::uint64_t line, std::string_view text = {}) noexcept;

  struct Counters {
    Counter bytes, frames, kernel_drops, error_frames, reopened, malformed;
  } counters_;
  StoppableWait waiting_;

 private:
  bool regain(std::int64_t until_ns) noexcept;
  void enter(TransportState state, int reason) noexcept;

  struct Link {
    std::int64_t since_ns = 0;  // of CLOCK_MONOTONIC
    bool open = false, once = false;
    bool returning = false;  // the next delivery is the first since the device came back
  };
  // The first fault of each kind, written once and then published.
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
  Notices notices_;
  Backoff backoff_;
  Link link_;
  Backlog backlog_;
  // Relaxed: each stands for itself. A reader may see a state before its reason, which is words for a person.
  std::atomic<TransportState> state_{TransportState::gone};
  std::atomic<int> reason_{0};
  Faults faults_;
};

}  // namespace ifog

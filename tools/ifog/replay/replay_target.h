// SPDX-License-Identifier: Apache-2.0
// Destinations of `ifog replay`.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/transport/network/ip_socket.h"
#include "drivers/transport/serial/serial_port.h"
#include "tools/ifog/replay/replay_timeline.h"

namespace ifog::tools {

// File descriptor to which `ifog replay` writes. It tries again while the system has no space, until the user
// interrupts.
class Outlet {
 public:
  // `name` is for messages. Does not own the descriptor.
  Outlet(std::string name, int fd) : name_(std::move(name)), fd_(fd) {}
  virtual ~Outlet() = default;
  Outlet(const Outlet&) = delete;
  Outlet& operator=(const Outlet&) = delete;

  // Sends all bytes, in several writes if necessary. False: interrupted. Throws std::runtime_error with one
  // line if the other end is closed or writing fails.
  bool send_bytes(const void* bytes, std::size_t n) { return send(bytes, n, false); }
  // Sends one datagram as a whole. Errors as above.
  bool send_datagram(const void* bytes, std::size_t n) { return send(bytes, n, true); }

  // Number of writes that the system rejected (ENOBUFS, EAGAIN) or accepted in part.
  [[nodiscard]] std::uint64_t retries() const { return retries_; }

 protected:
  // System calls, for tests: write() as write(2); pause() waits for space for a limited time.
  virtual ssize_t write(const void* bytes, std::size_t n);
  virtual void pause(int error);

 private:
  bool send(const void* bytes, std::size_t n, bool whole);

  std::string name_;
  int fd_;
  std::uint64_t retries_ = 0;
};

class ReplayTarget {
 public:
  enum class Form { stream, datagrams, can_frames };
  // name, fd: see Outlet. finish: called after the last byte; it also keeps the descriptor open until then.
  ReplayTarget(std::string name, int fd, Form form, const ReplayTimeline& timeline, bool buffering,
               std::function<void()> finish)
      : outlet_(std::move(name), fd),
        form_(form),
        timeline_(timeline),
        buffering_(buffering),
        finish_(std::move(finish)) {}

  // Sends item i and returns when the system has accepted it; waits while the system has no space. False:
  // interrupted. Throws std::runtime_error if the target is closed.
  bool send(std::size_t i);
  // Sends what is still buffered, unless interrupted.
  void finish();
  // Items in the buffer, accepted by send() but not yet by the system.
  [[nodiscard]] std::uint64_t buffered() const { return buffered_items_; }
  [[nodiscard]] std::uint64_t retries() const { return outlet_.retries(); }

 private:
  bool flush();

  Outlet outlet_;
  Form form_;
  const ReplayTimeline& timeline_;
  bool buffering_;
  std::function<void()> finish_;
  std::vector<std::uint8_t> buffer_;
  std::uint64_t buffered_items_ = 0;
};

struct HostAndPort {
  IpAddress host;
  std::uint16_t port = 0;
};

struct ReplayDestination {
  enum class Kind { can, serial, udp, tcp, file, fifo, standard_output };
  Kind kind = Kind::file;
  std::string name;  // interface, device, HOST:PORT or path
  HostAndPort at;    // of udp and tcp

  // "can:vcan0", "serial:/dev/ttyS0", "udp:127.0.0.1:5000", "tcp:[::1]:4001", "file:PATH", "fifo:PATH" or
  // "-". Throws WrongUsage for --to.
  static ReplayDestination parse(const std::string& text);
  [[nodiscard]] bool is_can() const { return kind == Kind::can; }
};

// Opens a destination. A FIFO waits for its reader; a TCP port listens, as a sensor does, and waits for its
// client; null if interrupted. With UDP each item is a datagram. `line` is for a serial device; its `device`
// is set here. `buffering` is for sending as fast as possible. CAN frames are written to a file as candump
// log. Keeps a reference to the timeline. Throws std::runtime_error with one line.
std::unique_ptr<ReplayTarget> open_target(const ReplayDestination& destination,
                                          const ReplayTimeline& timeline, SerialSettings line,
                                          bool buffering);

}  // namespace ifog::tools

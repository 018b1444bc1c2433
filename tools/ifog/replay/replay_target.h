// SPDX-License-Identifier: Apache-2.0
// Where `ifog replay` sends to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/transport/serial/serial_port.h"
#include "tools/ifog/replay/outlet.h"
#include "tools/ifog/replay/replay_timeline.h"

namespace ifog::tools {

class ReplayTarget {
 public:
  virtual ~ReplayTarget() = default;
  // Sends item i and returns once the system has taken it; waits where the system has no room for it at the
  // moment. False: interrupted before. Throws std::runtime_error when the target is gone.
  virtual bool send(std::size_t i) = 0;
  // Sends what is still held. False: interrupted.
  virtual bool finish() { return true; }
  // Items that send() took and the system has not.
  [[nodiscard]] virtual std::uint64_t held() const { return 0; }

  [[nodiscard]] std::uint64_t retries() const { return outlet_.retries(); }

 protected:
  ReplayTarget(std::string name, int fd) : outlet_(std::move(name), fd) {}
  Outlet outlet_;
};

struct ReplayDestination {
  enum class Kind { can, serial, udp, tcp, file, fifo, standard_output };
  Kind kind = Kind::file;
  std::string name;  // interface, device, HOST:PORT or path

  // "can:vcan0", "serial:/dev/ttyS0", "udp:127.0.0.1:5000", "tcp:[::1]:4001", "file:PATH", "fifo:PATH" or
  // "-". Throws std::runtime_error.
  static ReplayDestination parse(const std::string& text);
  [[nodiscard]] bool is_can() const { return kind == Kind::can; }
};

// Opens it; a FIFO waits for its reader and a TCP port, on which this end listens as a sensor does, for its
// client; null when interrupted meanwhile. Over UDP each item is a datagram. `line` is for a serial device,
// its `device` is set here. `hold` collects bytes before they are written, for sending as fast as possible.
// CAN frames go into a file as a candump log. Keeps a reference to the timeline. Throws std::runtime_error:
// one line.
std::unique_ptr<ReplayTarget> open_target(const ReplayDestination& destination,
                                          const ReplayTimeline& timeline, SerialSettings line, bool hold);

}  // namespace ifog::tools

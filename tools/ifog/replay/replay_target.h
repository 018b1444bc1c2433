// SPDX-License-Identifier: Apache-2.0
// Where `ifog replay` sends to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/transport/serial/serial_port.h"
#include "tools/ifog/replay/outlet.h"
#include "tools/ifog/replay/replay_timeline.h"

namespace ifog::tools {

class ReplayTarget {
 public:
  enum class Form { stream, datagrams, can_frames };
  // name, fd: see Outlet. finish: behind the last byte, and what keeps the descriptor open until then.
  ReplayTarget(std::string name, int fd, Form form, const ReplayTimeline& timeline, bool hold,
               std::function<void()> finish)
      : outlet_(std::move(name), fd),
        form_(form),
        timeline_(timeline),
        hold_(hold),
        finish_(std::move(finish)) {}

  // Sends item i and returns once the system has accepted it; waits where the system has no room for it at the
  // moment. False: interrupted before. Throws std::runtime_error when the target is gone.
  bool send(std::size_t i);
  // Sends what is still held. False: interrupted.
  bool finish();
  // Items that send() accepted and the system has not.
  [[nodiscard]] std::uint64_t held() const { return held_items_; }
  [[nodiscard]] std::uint64_t retries() const { return outlet_.retries(); }

 private:
  bool flush();

  Outlet outlet_;
  Form form_;
  const ReplayTimeline& timeline_;
  bool hold_;
  std::function<void()> finish_;
  std::vector<std::uint8_t> held_;
  std::uint64_t held_items_ = 0;
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

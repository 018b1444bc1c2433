// SPDX-License-Identifier: Apache-2.0
// A descriptor that `ifog replay` writes to. Where the system has no room at the moment it tries again; an
// interrupt by the user ends that.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace ifog::tools {

class Outlet {
 public:
  // `name` is for messages. Does not own the descriptor.
  Outlet(std::string name, int fd) : name_(std::move(name)), fd_(fd) {}
  virtual ~Outlet() = default;
  Outlet(const Outlet&) = delete;
  Outlet& operator=(const Outlet&) = delete;

  // All bytes, in as many portions as the system takes. False: interrupted before. Throws std::runtime_error
  // with one line: the other end is gone, or any other failure.
  bool send_bytes(const void* bytes, std::size_t n) { return send(bytes, n, false); }
  // One datagram, which the system accepts whole or not at all. As above.
  bool send_datagram(const void* bytes, std::size_t n) { return send(bytes, n, true); }

  // Times the system had no room (ENOBUFS, EAGAIN), or accepted a part only.
  [[nodiscard]] std::uint64_t retries() const { return retries_; }
  [[nodiscard]] int fd() const { return fd_; }

 protected:
  // The two places where it meets the system. write() as write(2); pause() waits for room, not for ever.
  virtual ssize_t write(const void* bytes, std::size_t n);
  virtual void pause(int error);

 private:
  bool send(const void* bytes, std::size_t n, bool whole);

  std::string name_;
  int fd_;
  std::uint64_t retries_ = 0;
};

}  // namespace ifog::tools

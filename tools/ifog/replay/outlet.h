// SPDX-License-Identifier: Apache-2.0
// File descriptor to which `ifog replay` writes. It tries again while the system has no space, until the user
// interrupts.
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

}  // namespace ifog::tools

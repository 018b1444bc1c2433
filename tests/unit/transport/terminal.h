// SPDX-License-Identifier: Apache-2.0
// A pseudo terminal in the place of a serial line, and the gyro at its other end.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "drivers/transport/serial/serial_port.h"
#include "tests/unit/test.h"

namespace ifog {

class Terminal final : public SerialPort {
 public:
  Terminal(const std::string& path, const LineErrors& errors)
      : errors_(errors), fd_(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    if (fd_ < 0) throw OpenError(path, "cannot open", errno, "a terminal");
    termios raw{};
    tcgetattr(fd_, &raw);
    cfmakeraw(&raw);
    raw.c_cc[VMIN] = 0;  // as libserialport sets it: a read without bytes is 0, not EAGAIN
    tcsetattr(fd_, TCSANOW, &raw);
  }
  ~Terminal() override { close(fd_); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  [[nodiscard]] int fd() const override { return fd_; }
  // A pseudo terminal counts none; these are a UART's.
  bool errors(LineErrors& out) const noexcept override {
    out = errors_;
    return true;
  }

 private:
  const LineErrors& errors_;
  int fd_;
};

// The other end of a new line, whose name ptsname() tells.
inline int open_line() {
  const int fd = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  EXPECT_GE(fd, 0);
  EXPECT_EQ(grantpt(fd), 0);
  EXPECT_EQ(unlockpt(fd), 0);
  return fd;
}

// The gyro's end of a line that can be pulled out and put back.
class Gyro {
 public:
  Gyro() { plug(); }
  ~Gyro() { pull(); }
  Gyro(const Gyro&) = delete;
  Gyro& operator=(const Gyro&) = delete;
  void plug() {
    fd_ = open_line();
    path_ = ptsname(fd_);
    // What is sent before the other end is opened would come back as an echo.
    termios raw{};
    ASSERT_EQ(tcgetattr(fd_, &raw), 0);
    cfmakeraw(&raw);
    ASSERT_EQ(tcsetattr(fd_, TCSANOW, &raw), 0);
    there_ = true;
  }
  void pull() {
    there_ = false;
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }
  void send(const std::string& text) const {
    ASSERT_EQ(write(fd_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  std::string receive(std::size_t n) const {
    std::string text(n, '\0');
    std::size_t have = 0;
    while (have < n) {
      const ssize_t got = read(fd_, text.data() + have, n - have);
      if (got <= 0) break;
      have += static_cast<std::size_t>(got);
    }
    return text.substr(0, have);
  }
  // What has come and was not received; nothing where nothing has.
  std::string drain() const {
    pollfd end{fd_, POLLIN, 0};
    if (::poll(&end, 1, 0) <= 0 || (end.revents & POLLIN) == 0) return "";
    std::string text(4096, '\0');
    const ssize_t got = read(fd_, text.data(), text.size());
    return text.substr(0, static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  }
  SerialOpener opener() {
    return [this](const SerialSettings&, std::string& warning) -> std::unique_ptr<SerialPort> {
      if (!there_) throw OpenError("gyro", "cannot open", ENOENT, "a serial device");
      warning = "no low latency";
      return std::make_unique<Terminal>(path_, errors);
    };
  }
  LineErrors errors;

 private:
  int fd_ = -1;
  std::atomic<bool> there_{false};
  std::string path_;
};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/replay/replay_target.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "drivers/capture/candump/candump.h"
#include "drivers/capture/files/output_file.h"
#include "drivers/ifog/quoted.h"
#include "drivers/transport/can/can_socket.h"
#include "drivers/transport/network/ip_socket.h"
#include "tools/ifog/console/interrupt.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

constexpr int kLook_ms = 100;             // between two looks at whether the user wants to stop
constexpr std::size_t kHeld = 1U << 16U;  // bytes collected when nothing is due at a time of its own

[[noreturn]] void fail(const std::string& name, const std::string& what, int error) {
  throw std::runtime_error(name + ": " + what + ": " + std::generic_category().message(error));
}

class CanTarget final : public ReplayTarget {
 public:
  CanTarget(const std::string& interface, const ReplayTimeline& timeline)
      : CanTarget(CanSocket(interface), interface, timeline) {}

  bool send(std::size_t i) override {
    canfd_frame frame{};
    const std::size_t size = to_socket(timeline_.frames[i], frame);
    return outlet_.send_datagram(&frame, size);
  }

 private:
  CanTarget(CanSocket socket, const std::string& interface, const ReplayTimeline& timeline)
      : ReplayTarget(interface, socket.fd()), timeline_(timeline), socket_(std::move(socket)) {
    socket_.receive_nothing();
  }

  const ReplayTimeline& timeline_;
  CanSocket socket_;
};

// Anything that takes bytes.
class ByteTarget final : public ReplayTarget {
 public:
  ByteTarget(const std::string& name, int fd, const ReplayTimeline& timeline, bool hold)
      : ReplayTarget(name, fd), timeline_(timeline), hold_(hold) {
    held_.reserve(kHeld + 2 * kCandumpLineMax);
  }
  ByteTarget(std::unique_ptr<SerialPort> port, const std::string& name, const ReplayTimeline& timeline,
             bool hold)
      : ByteTarget(name, port->fd(), timeline, hold) {
    port_ = std::move(port);
  }
  ByteTarget(IpSocket socket, const std::string& name, const ReplayTimeline& timeline, bool hold)
      : ByteTarget(name, socket.fd(), timeline, hold) {
    socket_ = std::move(socket);
  }
  ByteTarget(std::unique_ptr<OutputFile> file, const std::string& name, const ReplayTimeline& timeline,
             bool hold)
      : ByteTarget(name, file->descriptor(), timeline, hold) {
    file_ = std::move(file);
  }

  bool send(std::size_t i) override {
    if (timeline_.is_can()) {
      std::array<char, kCandumpLineMax> line{};
      const std::size_t n = format_candump_line(timeline_.frames[i], timeline_.interface(i), line.data());
      return put(reinterpret_cast<const std::uint8_t*>(line.data()), n);
    }
    const std::size_t begin = i == 0 ? 0 : timeline_.blocks[i - 1].end;
    return put(timeline_.bytes.data() + begin, timeline_.blocks[i].end - begin);
  }

  bool finish() override {
    if (!flush()) return false;
    if (port_ != nullptr) tcdrain(outlet_.fd());
    if (file_ != nullptr) file_->finish();
    return true;
  }

  [[nodiscard]] std::uint64_t held() const override { return held_items_; }

 private:
  bool put(const std::uint8_t* bytes, std::size_t n) {
    if (!hold_) return outlet_.send_bytes(bytes, n);
    held_.insert(held_.end(), bytes, bytes + n);
    if (held_.size() >= kHeld) return flush();
    ++held_items_;
    return true;
  }
  // What was interrupted in the middle is not sent a second time, and has not been sent.
  bool flush() {
    const bool done = outlet_.send_bytes(held_.data(), held_.size());
    held_.clear();
    if (done) held_items_ = 0;
    return done;
  }

  const ReplayTimeline& timeline_;
  bool hold_;
  std::unique_ptr<SerialPort> port_;  // one of the three
  IpSocket socket_;
  std::unique_ptr<OutputFile> file_;
  std::vector<std::uint8_t> held_;
  std::uint64_t held_items_ = 0;
};

class UdpTarget final : public ReplayTarget {
 public:
  UdpTarget(IpSocket socket, const std::string& name, const ReplayTimeline& timeline)
      : ReplayTarget(name, socket.fd()), timeline_(timeline), socket_(std::move(socket)) {}

  bool send(std::size_t i) override {
    const std::size_t begin = i == 0 ? 0 : timeline_.blocks[i - 1].end;
    return outlet_.send_datagram(timeline_.bytes.data() + begin, timeline_.blocks[i].end - begin);
  }

 private:
  const ReplayTimeline& timeline_;
  IpSocket socket_;
};

// The wait for a FIFO's reader can be interrupted: null.
std::unique_ptr<OutputFile> open_fifo(const std::string& name) {
  struct stat info {};
  const bool there = stat(name.c_str(), &info) == 0;
  if (!there && mkfifo(name.c_str(), 0644) != 0) fail(name, "cannot make a FIFO", errno);
  if (there && !S_ISFIFO(info.st_mode)) throw std::runtime_error(name + ": is no FIFO, expected one");
  warn("%s: waiting for a reader\n", name.c_str());
  for (;;) {
    const int fd = open(name.c_str(), O_WRONLY | O_CLOEXEC);
    if (fd >= 0) return std::make_unique<OutputFile>(name, fd);
    if (interrupted()) return nullptr;
    if (errno != EINTR) fail(name, "cannot open for writing", errno);
  }
}

struct HostAndPort {
  IpAddress host;
  std::uint16_t port = 0;
};

// "127.0.0.1:4001" or "[::1]:4001".
HostAndPort read_host_and_port(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  std::string host = text.substr(0, colon);
  const bool bracketed = host.starts_with('[') && host.ends_with(']');
  if (bracketed) host = host.substr(1, host.size() - 2);
  const auto address = IpAddress::parse(host);
  unsigned port = 0;
  const char* const end = text.data() + text.size();
  const bool whole = colon != std::string::npos &&
                     std::from_chars(text.data() + colon + 1, end, port).ptr == end && port >= 1 &&
                     port <= 65535;
  if (!whole || !address || address->is_v6() != bracketed)
    throw std::runtime_error("--to is " + in_quotes(text) +
                             ", expected a numeric address and a port, 127.0.0.1:4001 or [::1]:4001");
  return {*address, static_cast<std::uint16_t>(port)};
}

sockaddr_storage socket_address(const HostAndPort& at, const std::string& name, socklen_t& size) {
  const auto address = at.host.at_port(at.port, "", size);
  if (!address) fail(name, "no interface " + at.host.interface(), ENODEV);
  return *address;
}

IpSocket connected_udp(const std::string& name) {
  const HostAndPort to = read_host_and_port(name);
  socklen_t size = 0;
  const sockaddr_storage address = socket_address(to, name, size);
  IpSocket socket(to.host.family(), SOCK_DGRAM, name);
  if (const int error = socket.connect(address, size); error != 0) fail(name, "cannot send there", error);
  return socket;
}

// As a sensor or a serial server does: listens there and serves the first that connects. Not open when
// interrupted meanwhile.
IpSocket served_tcp(const std::string& name) {
  const HostAndPort at = read_host_and_port(name);
  socklen_t size = 0;
  const sockaddr_storage address = socket_address(at, name, size);
  IpSocket listener(at.host.family(), SOCK_STREAM, name);
  if (const int error = listener.set(SOL_SOCKET, SO_REUSEADDR, 1); error != 0)
    fail(name, "cannot listen", error);
  if (const int error = listener.bind(address, size); error != 0) fail(name, "cannot listen", error);
  if (listen(listener.fd(), 1) != 0) fail(name, "cannot listen", errno);
  warn("%s: waiting for a connection\n", name.c_str());
  for (;;) {
    IpSocket served = IpSocket::accepted(listener);
    if (served.is_open()) {
      // Each item at its time.
      if (const int error = served.set(IPPROTO_TCP, TCP_NODELAY, 1); error != 0)
        fail(name, "cannot serve", error);
      return served;
    }
    const int error = errno;
    if (interrupted()) return served;
    if (error != EAGAIN && error != EINTR && error != ECONNABORTED) fail(name, "cannot serve", error);
    pollfd ask{listener.fd(), POLLIN, 0};
    poll(&ask, 1, kLook_ms);
  }
}

}  // namespace

ReplayDestination ReplayDestination::parse(const std::string& text) {
  if (text == "-") return {Kind::standard_output, "standard output"};
  for (const auto& [prefix, kind] : {std::pair{"can:", Kind::can},
                                     {"serial:", Kind::serial},
                                     {"udp:", Kind::udp},
                                     {"tcp:", Kind::tcp},
                                     {"file:", Kind::file},
                                     {"fifo:", Kind::fifo}})
    if (text.starts_with(prefix) && text.size() > std::string(prefix).size()) {
      ReplayDestination out{kind, text.substr(std::string(prefix).size())};
      if (kind == Kind::udp || kind == Kind::tcp) read_host_and_port(out.name);
      return out;
    }
  throw std::runtime_error(
      "--to is " + in_quotes(text) +
      ", expected can:INTERFACE, serial:DEVICE, udp:HOST:PORT, tcp:HOST:PORT, file:PATH, "
      "fifo:PATH or -");
}

namespace {

void expect_bytes(const std::string& name, const ReplayTimeline& timeline, const char* where) {
  if (timeline.is_can())
    throw std::runtime_error(name + ": CAN frames cannot go " + where + ", expected bytes");
}

std::unique_ptr<ReplayTarget> can_target(const std::string& name, const ReplayTimeline& timeline) {
  if (!timeline.is_can())
    throw std::runtime_error(name +
                             ": raw bytes cannot go onto a CAN bus, expected a candump log or a CSV capture");
  return std::make_unique<CanTarget>(name, timeline);
}

std::unique_ptr<ReplayTarget> serial_target(const std::string& name, const ReplayTimeline& timeline,
                                            SerialSettings line, bool hold) {
  expect_bytes(name, timeline, "onto a serial line");
  line.device = name;
  if (line.baud == 0) line.baud = timeline.baud;
  if (line.baud == 0) throw std::runtime_error(name + ": no speed known, expected --baud");
  std::string warning;
  return std::make_unique<ByteTarget>(open_serial_port(line, warning), name, timeline, hold);
}

std::unique_ptr<ReplayTarget> udp_target(const std::string& name, const ReplayTimeline& timeline) {
  expect_bytes(name, timeline, "over UDP");
  return std::make_unique<UdpTarget>(connected_udp(name), name, timeline);
}

std::unique_ptr<ReplayTarget> tcp_target(const std::string& name, const ReplayTimeline& timeline, bool hold) {
  expect_bytes(name, timeline, "over TCP");
  IpSocket socket = served_tcp(name);
  if (!socket.is_open()) return nullptr;
  return std::make_unique<ByteTarget>(std::move(socket), name, timeline, hold);
}

std::unique_ptr<ReplayTarget> file_target(const std::string& name, std::unique_ptr<OutputFile> file,
                                          const ReplayTimeline& timeline, bool hold) {
  if (file == nullptr) return nullptr;
  return std::make_unique<ByteTarget>(std::move(file), name, timeline, hold);
}

}  // namespace

std::unique_ptr<ReplayTarget> open_target(const ReplayDestination& to, const ReplayTimeline& timeline,
                                          SerialSettings line, bool hold) {
  switch (to.kind) {
    case ReplayDestination::Kind::can:
      return can_target(to.name, timeline);
    case ReplayDestination::Kind::serial:
      return serial_target(to.name, timeline, std::move(line), hold);
    case ReplayDestination::Kind::udp:
      return udp_target(to.name, timeline);
    case ReplayDestination::Kind::tcp:
      return tcp_target(to.name, timeline, hold);
    case ReplayDestination::Kind::fifo:
      return file_target(to.name, open_fifo(to.name), timeline, hold);
    case ReplayDestination::Kind::standard_output:
      return file_target(to.name, std::make_unique<OutputFile>("-"), timeline, hold);
    case ReplayDestination::Kind::file:
      break;
  }
  return file_target(to.name, std::make_unique<OutputFile>(to.name), timeline, hold);
}

}  // namespace ifog::tools

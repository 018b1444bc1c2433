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
#include <ctime>
#include <span>
#include <system_error>

#include "drivers/capture/candump/candump.h"
#include "drivers/capture/files/file_kind.h"
#include "drivers/capture/files/output_file.h"
#include "drivers/ifog/quoted.h"
#include "drivers/transport/can/can_socket.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/interrupt.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

constexpr int kLook_ms = 100;                   // between checks for an interrupt
constexpr std::size_t kBufferSize = 1U << 16U;  // buffer size in bytes if items have no deadlines

[[noreturn]] void fail(const std::string& name, const std::string& what, int error) {
  throw refusal("{}: {}: {}", name, what, std::generic_category().message(error));
}

// Null if interrupted while waiting for the FIFO's reader.
std::unique_ptr<OutputFile> open_fifo(const std::string& name) {
  struct stat info {};
  const bool there = stat(name.c_str(), &info) == 0;
  if (!there && mkfifo(name.c_str(), 0644) != 0) fail(name, "cannot make a FIFO", errno);
  if (there && !S_ISFIFO(info.st_mode)) throw refusal("{}: is no FIFO, expected one", name);
  warn("{}: waiting for a reader\n", name);
  for (;;) {
    const int fd = open(name.c_str(), O_WRONLY | O_CLOEXEC);
    if (fd >= 0) return std::make_unique<OutputFile>(name, fd);
    if (interrupted()) return nullptr;
    if (errno != EINTR) fail(name, "cannot open for writing", errno);
  }
}

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
    throw WrongUsage("--to", "is " + in_quotes(text) +
                                 ", expected a numeric address and a port, 127.0.0.1:4001 or [::1]:4001");
  return {*address, static_cast<std::uint16_t>(port)};
}

sockaddr_storage socket_address(const HostAndPort& at, const std::string& name, socklen_t& size) {
  const auto address = at.host.at_port(at.port, "", size);
  if (!address) fail(name, "no interface " + at.host.interface(), ENODEV);
  return *address;
}

IpSocket connected_udp(const HostAndPort& to, const std::string& name) {
  socklen_t size = 0;
  const sockaddr_storage address = socket_address(to, name, size);
  IpSocket socket(to.host.family(), SOCK_DGRAM, name);
  if (const int error = socket.connect(address, size); error != 0) fail(name, "cannot send there", error);
  return socket;
}

// Listens like a sensor or serial server and accepts the first client. Not open if interrupted.
IpSocket served_tcp(const HostAndPort& at, const std::string& name) {
  socklen_t size = 0;
  const sockaddr_storage address = socket_address(at, name, size);
  IpSocket listener(at.host.family(), SOCK_STREAM, name);
  if (const int error = listener.set(SOL_SOCKET, SO_REUSEADDR, 1); error != 0)
    fail(name, "cannot listen", error);
  if (const int error = listener.bind(address, size); error != 0) fail(name, "cannot listen", error);
  if (listen(listener.fd(), 1) != 0) fail(name, "cannot listen", errno);
  warn("{}: waiting for a connection\n", name);
  for (;;) {
    IpSocket served = IpSocket::accepted(listener);
    if (served.is_open()) {
      // Send each item at its time.
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

constexpr int kPatience_ms = 100;  // between checks for an interrupt

}  // namespace

ReplayDestination ReplayDestination::parse(const std::string& text) {
  if (text == "-") return {Kind::standard_output, "standard output", {}};
  for (const auto& [prefix, kind] : {std::pair<std::string, Kind>{"can:", Kind::can},
                                     {"serial:", Kind::serial},
                                     {"udp:", Kind::udp},
                                     {"tcp:", Kind::tcp},
                                     {"file:", Kind::file},
                                     {"fifo:", Kind::fifo}})
    if (text.starts_with(prefix) && text.size() > prefix.size()) {
      ReplayDestination out{kind, text.substr(prefix.size()), {}};
      if (kind == Kind::udp || kind == Kind::tcp) out.at = read_host_and_port(out.name);
      if (kind == Kind::file && is_packed_name(out.name))
        throw WrongUsage("--to",
                         "is " + in_quotes(text) + ", expected a name without .gz: nothing is packed");
      return out;
    }
  throw WrongUsage("--to", "is " + in_quotes(text) +
                               ", expected can:INTERFACE, serial:DEVICE, udp:HOST:PORT, tcp:HOST:PORT, "
                               "file:PATH, fifo:PATH or -");
}

bool ReplayTarget::send(std::size_t i) {
  if (form_ == Form::can_frames) {
    canfd_frame frame{};
    const std::size_t size = to_socket(timeline_.frames[i], frame);
    return outlet_.send_datagram(&frame, size);
  }
  std::array<char, kCandumpLineMax> line{};
  std::span<const std::uint8_t> item;
  if (timeline_.is_can()) {
    const std::size_t size = format_candump_line(timeline_.frames[i], timeline_.interface(i), line.data());
    item = {reinterpret_cast<const std::uint8_t*>(line.data()), size};
  } else {
    const std::size_t begin = i == 0 ? 0 : timeline_.blocks[i - 1].end;
    item = std::span(timeline_.bytes).subspan(begin, timeline_.blocks[i].end - begin);
  }
  if (form_ == Form::datagrams) return outlet_.send_datagram(item.data(), item.size());
  if (!buffering_) return outlet_.send_bytes(item.data(), item.size());
  buffer_.insert(buffer_.end(), item.begin(), item.end());
  if (buffer_.size() >= kBufferSize) return flush();
  ++buffered_items_;
  return true;
}

// After an interrupt the rest is neither sent nor repeated.
bool ReplayTarget::flush() {
  const bool done = outlet_.send_bytes(buffer_.data(), buffer_.size());
  buffer_.clear();
  if (done) buffered_items_ = 0;
  return done;
}

void ReplayTarget::finish() {
  if (flush()) finish_();
}

std::unique_ptr<ReplayTarget> open_target(const ReplayDestination& to, const ReplayTimeline& timeline,
                                          SerialSettings line, bool buffering) {
  using Kind = ReplayDestination::Kind;
  using Form = ReplayTarget::Form;
  const auto target = [&](int fd, Form form, std::function<void()> finish) {
    return std::make_unique<ReplayTarget>(to.name, fd, form, timeline, buffering, std::move(finish));
  };
  const auto expect_bytes = [&](const char* where) {
    if (timeline.is_can()) throw refusal("{}: CAN frames cannot go {}, expected bytes", to.name, where);
  };
  switch (to.kind) {
    case Kind::can: {
      if (!timeline.is_can())
        throw refusal("{}: raw bytes cannot go onto a CAN bus, expected a candump log or a CSV capture",
                      to.name);
      const auto socket = std::make_shared<CanSocket>(to.name);
      socket->receive_nothing();
      return target(socket->fd(), Form::can_frames, [socket] {});
    }
    case Kind::serial: {
      expect_bytes("onto a serial line");
      line.device = to.name;
      if (line.baud == 0) line.baud = timeline.baud;
      if (line.baud == 0) throw refusal("{}: no speed known, expected --baud", to.name);
      std::string warning;
      const std::shared_ptr<SerialPort> port = open_serial_port(line, warning);
      return target(port->fd(), Form::stream, [port] { tcdrain(port->fd()); });
    }
    case Kind::udp: {
      expect_bytes("over UDP");
      const auto socket = std::make_shared<IpSocket>(connected_udp(to.at, to.name));
      return target(socket->fd(), Form::datagrams, [socket] {});
    }
    case Kind::tcp: {
      expect_bytes("over TCP");
      const auto socket = std::make_shared<IpSocket>(served_tcp(to.at, to.name));
      if (!socket->is_open()) return nullptr;
      return target(socket->fd(), Form::stream, [socket] {});
    }
    case Kind::fifo:
    case Kind::standard_output:
    case Kind::file:
      break;
  }
  const std::shared_ptr<OutputFile> file =
      to.kind == Kind::fifo ? open_fifo(to.name)
                            : std::make_unique<OutputFile>(to.kind == Kind::standard_output ? "-" : to.name);
  if (file == nullptr) return nullptr;
  return target(file->descriptor(), Form::stream, [file] { file->finish(); });
}

ssize_t Outlet::write(const void* bytes, std::size_t n) { return ::write(fd_, bytes, n); }

void Outlet::pause(int error) {
  if (error == ENOBUFS) {
    // poll() does not see a full queue of a CAN interface: wait for about one frame at 1 Mbit/s.
    const timespec frame{0, 100'000};
    nanosleep(&frame, nullptr);
    return;
  }
  pollfd ask{fd_, POLLOUT, 0};
  poll(&ask, 1, kPatience_ms);
}

bool Outlet::send(const void* bytes, std::size_t n, bool whole) {
  const auto* at = static_cast<const unsigned char*>(bytes);
  while (n > 0) {
    const ssize_t accepted = write(at, n);
    // Part of a datagram is a different datagram; a second write cannot repair that.
    if (whole && accepted > 0 && static_cast<std::size_t>(accepted) != n)
      throw refusal("{}: cannot send: {} of {} bytes of a frame were accepted", name_, accepted, n);
    if (accepted > 0) {
      at += accepted;
      n -= static_cast<std::size_t>(accepted);
      if (n > 0) ++retries_;
      continue;
    }
    const int error = accepted < 0 ? errno : EAGAIN;
    if (interrupted()) return false;
    // Of an earlier datagram that nobody received; a sensor goes on sending.
    if (whole && error == ECONNREFUSED) continue;
    if (error == EINTR) continue;
    if (error == EPIPE) throw refusal("{}: the reader went away", name_);
    if (error != EAGAIN && error != ENOBUFS)
      throw refusal("{}: cannot send: {}", name_, std::generic_category().message(error));
    ++retries_;
    pause(error);
  }
  return true;
}

}  // namespace ifog::tools

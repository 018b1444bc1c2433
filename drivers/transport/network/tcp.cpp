// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/network/tcp.h"
#include "drivers/transport/clock.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "drivers/transport/network/ip_socket.h"
#include "drivers/transport/receiving_socket.h"

namespace ifog {
namespace {

// The kernel's limit is minutes, with up to a minute between attempts.
constexpr std::int64_t kAttempt_ns = 500'000'000;
constexpr std::int64_t kHearOut_ns = 300'000'000;
constexpr int kQuietBeforeProbe_s = 1, kProbeEvery_s = 1, kProbes = 2;

// Detects texts of a serial-to-TCP server: a message before it closes ("Port already in use"), and telnet
// (RFC 854), which doubles each byte FF and inserts commands.
class ServerWords {
 public:
  void connected() noexcept { *this = {}; }
  void came(std::span<const std::uint8_t> bytes) noexcept {
    if (length_ < text_.size())
      std::copy_n(bytes.begin(), std::min(bytes.size(), text_.size() - length_), text_.begin() + length_);
    length_ += bytes.size();
    if (runs_ < kShow) count_runs(bytes);
  }
  // All received bytes if they are a sentence; else "".
  [[nodiscard]] std::string_view sentence() const noexcept {
    std::string_view text(text_.data(), std::min(length_, text_.size()));
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
    const auto spoken = [](char c) { return (c >= ' ' && c <= '~') || c == '\r' || c == '\n' || c == '\t'; };
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    const bool words = length_ <= text_.size() && std::ranges::all_of(text, spoken) &&
                       2 * std::ranges::count_if(text, letter) > static_cast<long>(text.size());
    return words ? text : std::string_view();
  }
  // True if it started with a telnet command, or doubled every FF.
  [[nodiscard]] bool telnet() const noexcept {
    const auto at = [this](std::size_t i) { return static_cast<std::uint8_t>(text_[i]); };
    const bool command = length_ >= 3 && at(0) == 0xFF && at(1) >= 0xFB && at(1) <= 0xFE && at(2) < 0x40;
    return command || (runs_ >= kShow && odd_ == 0);
  }

 private:
  static constexpr int kShow = 32;  // runs of FF; without doubling half of them are odd

  void count_runs(std::span<const std::uint8_t> bytes) noexcept {
    for (const std::uint8_t byte : bytes) {
      if (byte == 0xFF) {
        ++run_;
      } else if (run_ > 0) {
        ++runs_;
        odd_ += run_ % 2;
        run_ = 0;
      }
    }
  }

  std::array<char, 200> text_{};
  std::size_t length_ = 0;
  int run_ = 0, runs_ = 0, odd_ = 0;
};

class TcpTransport final : public Transport {
 public:
  TcpTransport(const TcpSettings& settings, IpAddress host)
      : Transport("tcp:" + host_and_port(settings.host, settings.port)),
        settings_(settings),
        host_(std::move(host)) {}

 private:
  bool connect(std::string& warning, std::int64_t until_ns) override;
  Delivery receive(std::int64_t until_ns) noexcept override;
  [[nodiscard]] bool more_waits() noexcept override { return waiting_.is_readable(socket_.fd()); }
  void begin();
  void check_answer();
  void send_opening();
  void hear_out(std::int64_t until_ns);
  void hung_up(int error) noexcept;
  [[noreturn]] void refuse(const std::string& what, int error, const std::string& expected);

  TcpSettings settings_;
  IpAddress host_;
  IpSocket socket_;
  std::int64_t limit_ns_ = 0;  // deadline of the present attempt
  ServerWords words_;
  bool turned_away_ = false;  // the last connection sent a message and was closed
  bool telnet_reported_ = false;
  KernelStamps stamps_;
  ControlRoom control_{};
  std::array<std::uint8_t, 16384> buffer_{};
};

void TcpTransport::refuse(const std::string& what, int error, const std::string& expected) {
  socket_.close();
  throw OpenError(name(), what, error, expected);
}

bool TcpTransport::connect(std::string& warning, std::int64_t until_ns) {
  // An open socket here is an attempt of the previous call.
  if (!socket_.is_open()) begin();
  switch (waiting_.wait(socket_.fd(), POLLOUT, std::min(until_ns, limit_ns_))) {
    case Wake::stopped:
      return false;
    case Wake::timeout:
      if (monotonic_ns() < limit_ns_) return false;
      refuse("cannot connect", ETIMEDOUT, "a device or server that listens there");
    case Wake::ready:
      break;
  }
  check_answer();
  ask_for_times(socket_.fd(), name(), warning);
  stamps_.begin(realtime_ns(), arrival_clock_ns());
  words_.connected();
  if (turned_away_) hear_out(monotonic_ns() + kHearOut_ns);
  send_opening();
  return true;
}

void TcpTransport::begin() {
  socklen_t size = 0;
  const auto address = host_.at_port(settings_.port, "", size);
  if (!address) throw OpenError(name(), "cannot connect", ENODEV, "an interface " + host_.interface());
  socket_ = IpSocket(host_.family(), SOCK_STREAM, name());
  for (const auto& [option, value] :
       {std::pair{TCP_KEEPIDLE, kQuietBeforeProbe_s}, {TCP_KEEPINTVL, kProbeEvery_s}, {TCP_KEEPCNT, kProbes}})
    if (const int error = socket_.set(IPPROTO_TCP, option, value); error != 0)
      refuse("cannot ask for probes", error, "a kernel with TCP keep-alive");
  if (const int error = socket_.set(SOL_SOCKET, SO_KEEPALIVE, 1); error != 0)
    refuse("cannot ask for probes", error, "a kernel with TCP keep-alive");
  limit_ns_ = monotonic_ns() + kAttempt_ns;
  const int error = socket_.connect(*address, size);
  if (error != 0 && error != EINPROGRESS && error != EINTR)
    refuse("cannot connect", error, "a device or server that listens there");
}

void TcpTransport::check_answer() {
  int error = 0;
  socklen_t size = sizeof error;
  if (getsockopt(socket_.fd(), SOL_SOCKET, SO_ERROR, &error, &size) != 0) error = errno;
  sockaddr_storage ours{}, theirs{};
  socklen_t ours_size = sizeof ours, theirs_size = sizeof theirs;
  // A local port without a listener may be assigned to the connecting socket itself, which is then connected
  // to itself (simultaneous open, RFC 9293, 3.5).
  if (error == 0 && getsockname(socket_.fd(), reinterpret_cast<sockaddr*>(&ours), &ours_size) == 0 &&
      getpeername(socket_.fd(), reinterpret_cast<sockaddr*>(&theirs), &theirs_size) == 0 &&
      ours_size == theirs_size && std::memcmp(&ours, &theirs, ours_size) == 0)
    error = ECONNREFUSED;
  if (error != 0) refuse("cannot connect", error, "a device or server that listens there");
}

// A server that rejected us may do so again; the line counts as open after a while without rejection.
void TcpTransport::hear_out(std::int64_t until_ns) {
  std::array<std::uint8_t, 256> said{};
  for (ssize_t n = 0;;) {
    short happened = 0;
    if (waiting_.wait(socket_.fd(), POLLIN | POLLRDHUP, until_ns, &happened) != Wake::ready) break;
    n = recv(socket_.fd(), said.data(), said.size(), MSG_PEEK | MSG_DONTWAIT);
    words_.connected();
    if (n > 0) words_.came(std::span(said).first(static_cast<std::size_t>(n)));
    if (n == 0 || (happened & (POLLRDHUP | POLLHUP)) != 0)
      refuse("the server closes the connection", ECONNREFUSED, "that no other program has its line");
    if (words_.sentence().empty()) break;
    timespec pause{0, 10'000'000};
    nanosleep(&pause, nullptr);
    if (monotonic_ns() >= until_ns) break;
  }
  words_.connected();
  turned_away_ = false;
}

void TcpTransport::hung_up(int error) noexcept {
  const std::string_view sentence = words_.sentence();
  turned_away_ = !sentence.empty();
  if (turned_away_) {
    report("the server sent this and closed the connection", 0, sentence);
    error = ECONNREFUSED;
  }
  socket_.close();
  lost(error);
}

// At most 64 bytes, which fit into a new socket's buffer.
void TcpTransport::send_opening() {
  if (opening().empty()) return;
  const ssize_t n = send(socket_.fd(), opening().data(), opening().size(), MSG_NOSIGNAL);
  if (n != static_cast<ssize_t>(opening().size()))
    refuse("cannot send the opening bytes", n < 0 ? errno : EIO, "a device that takes them");
}

Delivery TcpTransport::receive(std::int64_t until_ns) noexcept {
  if (waiting_.wait(socket_.fd(), POLLIN, until_ns) != Wake::ready) return {};
  iovec room{buffer_.data(), buffer_.size()};
  msghdr message{};
  message.msg_iov = &room;
  message.msg_iovlen = 1;
  message.msg_control = control_.bytes;
  message.msg_controllen = sizeof control_.bytes;
  const ssize_t n = recvmsg(socket_.fd(), &message, MSG_DONTWAIT);
  if (n > 0) {
    Delivery delivery;
    delivery.arrival_ns = delivery.read_ns = arrival_clock_ns();
    stamps_.begin(realtime_ns(), delivery.arrival_ns);
    if (const ReceiveControl said = receive_control(message); said.arrival_ns != 0)
      delivery.arrival_ns = stamps_.on_arrival_clock(said.arrival_ns);
    delivery.bytes = std::span<const std::uint8_t>(buffer_).first(static_cast<std::size_t>(n));
    words_.came(delivery.bytes);
    if (words_.telnet() && !std::exchange(telnet_reported_, true))
      report("the server speaks telnet, which doubles every byte FF: set its port to raw", 0);
    return delivery;
  }
  const int error = n < 0 ? errno : ECONNRESET;
  if (error == EINTR || error == EAGAIN) return {};
  hung_up(error);
  return {};
}

}  // namespace

std::string tcp_complaint(const TcpSettings& settings) {
  if (settings.port == 0) return "port = 0: expected 1 ... 65535";
  const auto host = IpAddress::parse(settings.host);
  const bool reachable =
      host && !host->is_multicast() && (!host->is_link_local_v6() || !host->interface().empty());
  if (reachable) return "";
  return "host = " + in_quotes(settings.host) +
         ": expected a numeric address, \"192.168.1.20\", \"fd00::20\" or \"fe80::20%eth0\"; names are not "
         "looked up";
}

std::unique_ptr<Transport> make_tcp_transport(const TcpSettings& settings) {
  if (const std::string wrong = tcp_complaint(settings); !wrong.empty())
    throw std::runtime_error("tcp transport: " + wrong);
  return std::make_unique<TcpTransport>(settings, *IpAddress::parse(settings.host));
}

}  // namespace ifog

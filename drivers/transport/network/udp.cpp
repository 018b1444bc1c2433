// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/network/udp.h"
#include "drivers/transport/clock.h"

#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "drivers/ifog/quoted.h"
#include "drivers/transport/network/ip_socket.h"
#include "drivers/transport/receiving_socket.h"

namespace ifog {
namespace {

constexpr std::size_t kDatagramsAtOnce = 16;  // datagrams per system call
constexpr std::size_t kLongest = 1U << 16U;   // largest UDP payload
constexpr std::int64_t kInterfacePeriod_ns = 500'000'000;

struct Addresses {
  IpAddress local;  // address or group to listen on
  std::optional<IpAddress> host;
};

// Resolves the addresses; returns "" or the error.
std::string resolve(const UdpSettings& settings, Addresses& out) {
  const auto wrong = [](const char* key, const std::string& value, const std::string& expected) {
    return std::string(key) + " = " + in_quotes(value) + ": expected " + expected;
  };
  if (settings.port == 0) return "port = 0: expected 1 ... 65535";
  if (!settings.host.empty()) {
    out.host = IpAddress::parse(settings.host);
    if (!out.host || out.host->is_multicast())
      return wrong("host", settings.host, "the sensor's numeric address, \"192.168.1.20\" or \"fd00::20\"");
  }
  if (settings.host_port != 0 && !out.host) return "host_port: expected none without host";
  const bool joined = !settings.group.empty();
  if (joined && !settings.bind.empty())
    return wrong("bind", settings.bind, "no address with group: it listens to the group");
  if (joined && settings.interface.empty())
    return "interface: missing; expected the interface on which the group is joined, \"eth0\"";
  if (settings.interface.size() >= IFNAMSIZ)
    return wrong("interface", settings.interface, "an interface's name, 1 to 15 letters");
  if (!joined && !settings.interface.empty())
    return wrong("interface", settings.interface, "none without group; bind selects the local address");
  const std::string any = out.host && out.host->is_v6() ? "::" : "0.0.0.0";
  const std::string& text = joined ? settings.group : settings.bind.empty() ? any : settings.bind;
  const auto local = IpAddress::parse(text);
  if (!local || local->is_multicast() != joined)
    return joined ? wrong("group", text, "a multicast address, \"239.1.2.3\" or \"ff02::1:2\"")
                  : wrong("bind", text, "a numeric address of this computer, \"192.168.1.1\" or \"fd00::1\"");
  if (out.host && out.host->is_v6() != local->is_v6())
    return wrong("host", settings.host, "an address of the same kind, IPv4 or IPv6, as " + text);
  out.local = *local;
  return "";
}

class UdpTransport final : public Transport {
 public:
  UdpTransport(const UdpSettings& settings, Addresses addresses);

 private:
  struct Arrival {
    std::int64_t ns;
    bool stamped;
  };
  // Datagrams of one system call.
  struct Batch {
    std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(kDatagramsAtOnce * kLongest);
    std::array<sockaddr_storage, kDatagramsAtOnce> senders{};
    ReceiveBatch<kDatagramsAtOnce> messages;
    std::array<Arrival, kDatagramsAtOnce> arrivals{};
    std::size_t count = 0, next = 0;  // number read; next to be delivered
  };

  bool connect(std::string& warning, std::int64_t until_ns) override;
  Delivery receive(std::int64_t until_ns) noexcept override;
  [[nodiscard]] bool more_waits() noexcept override {
    return batch_.next < batch_.count || waiting_.is_readable(socket_.fd());
  }
  void join(const IpSocket& socket) const;
  void send_opening(const IpSocket& socket) const;
  void look_at_interface() noexcept;
  void take(std::size_t received) noexcept;
  void give_up(int error) noexcept;
  Delivery next() noexcept;
  [[nodiscard]] bool is_of_port(std::size_t i) noexcept;

  UdpSettings settings_;
  Addresses addresses_;
  IpSocket socket_;
  unsigned interface_index_ = 0;
  std::int64_t next_look_ns_ = 0;
  std::uint32_t drops_ = 0;
  std::uint16_t sends_from_ = 0;  // the host's sending port; 0: none yet
  std::int64_t sent_ns_ = 0;      // time of its last datagram
  KernelStamps stamps_;
  Batch batch_;
};

UdpTransport::UdpTransport(const UdpSettings& settings, Addresses addresses)
    : Transport("udp:" + host_and_port(!settings.group.empty() ? settings.group
                                       : !settings.bind.empty()
                                           ? settings.bind
                                           : (addresses.local.is_v6() ? "::" : "0.0.0.0"),
                                       settings.port)),
      settings_(settings),
      addresses_(std::move(addresses)) {
  for (std::size_t i = 0; i < kDatagramsAtOnce; ++i)
    batch_.messages.place(i, {&batch_.bytes[i * kLongest], kLongest}, &batch_.senders[i]);
}

bool UdpTransport::connect(std::string& warning, std::int64_t /*until_ns*/) {
  socket_.close();
  batch_.count = batch_.next = 0;
  drops_ = sends_from_ = 0;
  IpSocket fresh(addresses_.local.family(), SOCK_DGRAM, name());
  const auto require = [this](int error, const char* what, const char* expected) {
    if (error != 0) throw OpenError(name(), what, error, expected);
  };
  if (addresses_.local.is_v6())
    require(fresh.set(IPPROTO_IPV6, IPV6_V6ONLY, 1), "cannot keep to IPv6", "a kernel with IPv6");
  // Several programs may listen to a group. Otherwise a second listener would get the first one's datagrams.
  if (!settings_.group.empty())
    require(fresh.set(SOL_SOCKET, SO_REUSEADDR, 1), "cannot share the port", "a kernel that allows it");
  socklen_t size = 0;
  const auto address = addresses_.local.at_port(settings_.port, settings_.interface, size);
  require(address ? 0 : ENODEV, "cannot listen", "an existing interface");
  require(fresh.bind(*address, size), "cannot listen", "an address of this computer and a port that is free");
  if (!settings_.group.empty()) join(fresh);
  interface_index_ = settings_.interface.empty() ? 0 : if_nametoindex(settings_.interface.c_str());
  ask_for_drops(fresh.fd());
  ask_for_room(fresh.fd(), settings_.receive_buffer_bytes, name(), warning);
  ask_for_times(fresh.fd(), name(), warning);
  stamps_.begin(realtime_ns(), arrival_clock_ns());
  send_opening(fresh);
  socket_ = std::move(fresh);
  return true;
}

void UdpTransport::join(const IpSocket& socket) const {
  socklen_t size = 0;
  group_req request{};
  request.gr_interface = if_nametoindex(settings_.interface.c_str());
  const auto group = addresses_.local.at_port(settings_.port, settings_.interface, size);
  if (request.gr_interface == 0 || !group)
    throw OpenError(name(), "cannot join the group", ENODEV, "an interface " + settings_.interface);
  std::memcpy(&request.gr_group, &*group, size);
  const int level = addresses_.local.is_v6() ? IPPROTO_IPV6 : IPPROTO_IP;
  if (setsockopt(socket.fd(), level, MCAST_JOIN_GROUP, &request, sizeof request) != 0)
    throw OpenError(name(), "cannot join the group", errno,
                    "an interface " + settings_.interface + " that is up and has an address");
}

void UdpTransport::send_opening(const IpSocket& socket) const {
  if (opening().empty()) return;
  socklen_t size = 0;
  const auto to = addresses_.host ? addresses_.host->at_port(
                                        settings_.host_port != 0 ? settings_.host_port : settings_.port,
                                        settings_.interface, size)
                                  : std::nullopt;
  if (!to)
    throw OpenError(name(), "cannot send the driver's opening bytes", EDESTADDRREQ,
                    "host, the sensor's address");
  if (sendto(socket.fd(), opening().data(), opening().size(), MSG_NOSIGNAL,
             reinterpret_cast<const sockaddr*>(&*to), size) < 0)
    throw OpenError(name(), "cannot send the driver's opening bytes", errno, "a way to " + settings_.host);
}

Delivery UdpTransport::receive(std::int64_t until_ns) noexcept {
  if (const Delivery waiting = next(); !waiting.empty()) return waiting;
  batch_.count = batch_.next = 0;
  const Wake wake = waiting_.wait(socket_.fd(), POLLIN, until_ns);
  if (wake == Wake::timeout) look_at_interface();
  if (wake != Wake::ready) return {};
  if (const int n = batch_.messages.receive(socket_.fd()); n > 0)
    take(static_cast<std::size_t>(n));
  else
    give_up(n < 0 ? errno : EAGAIN);
  return next();
}

// Group membership is lost silently when the interface disappears; a new interface of this name must be
// joined again.
void UdpTransport::look_at_interface() noexcept {
  const std::int64_t now = monotonic_ns();
  if (interface_index_ == 0 || now < next_look_ns_) return;
  next_look_ns_ = now + kInterfacePeriod_ns;
  if (if_nametoindex(settings_.interface.c_str()) == interface_index_) return;
  socket_.close();
  lost(ENODEV);
}

void UdpTransport::give_up(int error) noexcept {
  // ECONNREFUSED answers the opening bytes if the sensor does not listen yet.
  if (error == EINTR || error == EAGAIN || error == ECONNREFUSED) return;
  socket_.close();
  lost(error);
}

void UdpTransport::take(std::size_t received) noexcept {
  batch_.count = received;
  const std::int64_t read_at = arrival_clock_ns();
  stamps_.begin(realtime_ns(), read_at);
  for (std::size_t i = 0; i < batch_.count; ++i) {
    const ReceiveControl said = batch_.messages.control(i);
    if (said.has_drops) {
      counters_.kernel_drops.add(said.drops - drops_);  // modulo 2^32, as in the kernel
      drops_ = said.drops;
    }
    const bool stamped = said.arrival_ns != 0;
    batch_.arrivals[i] = {stamped ? stamps_.on_arrival_clock(said.arrival_ns) : read_at, stamped};
  }
}

bool UdpTransport::is_of_port(std::size_t i) noexcept {
  const std::uint16_t port =
      ntohs(reinterpret_cast<const sockaddr_in&>(batch_.senders[i]).sin_port);  // also valid for IPv6
  if (settings_.host_port != 0) return port == settings_.host_port;
  const bool another = sends_from_ != 0 && port != sends_from_;
  if (another && batch_.arrivals[i].ns < sent_ns_ + 2'000'000'000 /* no sensor restarts in less */)
    return false;
  sends_from_ = port;
  sent_ns_ = batch_.arrivals[i].ns;
  return true;
}

Delivery UdpTransport::next() noexcept {
  for (; batch_.next < batch_.count; ++batch_.next) {
    const std::size_t i = batch_.next, length = batch_.messages.length(i);
    if (addresses_.host && !addresses_.host->is_host_of(batch_.senders[i])) {
      report("datagrams from another host, which are dropped", 0);
      continue;
    }
    if (addresses_.host && !is_of_port(i)) {
      report("datagrams from another port of host are dropped; host_port selects the sensor's", 0);
      continue;
    }
    if (length == 0) continue;
    ++batch_.next;
    Delivery delivery;
    delivery.bytes = {&batch_.bytes[i * kLongest], length};
    delivery.arrival_ns = batch_.arrivals[i].ns;
    delivery.stamped = batch_.arrivals[i].stamped;
    return delivery;
  }
  return {};
}

}  // namespace

std::string udp_complaint(const UdpSettings& settings) {
  Addresses addresses;
  return resolve(settings, addresses);
}

std::unique_ptr<Transport> make_udp_transport(const UdpSettings& settings) {
  Addresses addresses;
  if (const std::string wrong = resolve(settings, addresses); !wrong.empty())
    throw std::runtime_error("udp transport: " + wrong);
  return std::make_unique<UdpTransport>(settings, std::move(addresses));
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/can/can.h"
#include "drivers/transport/clock.h"

#include <linux/sock_diag.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>

#include "drivers/transport/can/can_socket.h"
#include "drivers/transport/receiving_socket.h"

namespace ifog {
namespace {

constexpr std::size_t kFramesAtOnce = 64;  // frames per system call

class CanTransport final : public Transport {
 public:
  explicit CanTransport(const CanSettings& settings) : Transport(settings.interface), settings_(settings) {
    for (std::size_t i = 0; i < kFramesAtOnce; ++i) batch_.place(i, {&raw_[i], sizeof raw_[i]});
  }

 private:
  bool connect(std::string& warning, std::int64_t until_ns) override;
  Delivery receive(std::int64_t until_ns) noexcept override;
  int receive_waiting() noexcept;
  std::span<const ifog_can_frame> accept(std::size_t received, std::int64_t read_at) noexcept;
  void count_losses() noexcept override;
  void count_drops(std::uint32_t drops) noexcept;

  CanSettings settings_;
  CanSocket socket_;
  std::uint32_t drops_ = 0;
  int leaving_ = 0;  // errno of the interface's disappearance; waiting frames are still read
  KernelStamps stamps_;
  std::array<canfd_frame, kFramesAtOnce> raw_{};
  ReceiveBatch<kFramesAtOnce> batch_;
  std::array<ifog_can_frame, kFramesAtOnce> frames_{};
};

bool CanTransport::connect(std::string& warning, std::int64_t /*until_ns*/) {
  if (!opening().empty())
    throw OpenError(name(), "cannot send the driver's opening bytes", EOPNOTSUPP,
                    "a driver without them on CAN");
  socket_.close();  // before another is opened: it may be a new interface of the same name
  CanSocket fresh(settings_.interface);
  fresh.receive_only(settings_.ids, settings_.interface);
  socket_ = std::move(fresh);
  drops_ = 0;
  leaving_ = 0;
  stamps_.begin(realtime_ns(), arrival_clock_ns());
  ask_for_drops(socket_.fd());
  ask_for_room(socket_.fd(), settings_.receive_buffer_bytes, name(), warning);
  ask_for_times(socket_.fd(), name(), warning);
  return true;
}

Delivery CanTransport::receive(std::int64_t until_ns) noexcept {
  if (leaving_ == 0 && waiting_.wait(socket_.fd(), POLLIN, until_ns) != Wake::ready) {
    count_losses();
    return {};
  }
  if (const int n = receive_waiting(); n > 0) {
    Delivery delivery;
    delivery.read_ns = arrival_clock_ns();
    delivery.frames = accept(static_cast<std::size_t>(n), delivery.read_ns);
    return delivery;
  }
  if (leaving_ == 0) return {};
  count_losses();
  socket_.close();
  lost(leaving_);
  return {};
}

// Frames in the socket, or none and the reason why the interface is gone. ENETDOWN (set down) and ENODEV
// (unplugged) are each reported once; earlier frames are read after them.
int CanTransport::receive_waiting() noexcept {
  constexpr int kErrors = 4;  // more than one socket can report
  for (int errors = 0; errors < kErrors; ++errors) {
    const int n = batch_.receive(socket_.fd());
    if (n > 0) return n;
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) return 0;
    leaving_ = n < 0 ? errno : ENODEV;
  }
  return 0;
}

// Each frame carries the count of drops before it; after the last one it must be requested.
void CanTransport::count_losses() noexcept {
  std::array<std::uint32_t, SK_MEMINFO_VARS> info{};
  socklen_t size = sizeof info;
  if (getsockopt(socket_.fd(), SOL_SOCKET, SO_MEMINFO, info.data(), &size) == 0 &&
      size > SK_MEMINFO_DROPS * sizeof info[0])
    count_drops(info[SK_MEMINFO_DROPS]);
}

// Modulo 2^32, as in the kernel. A frame's count may be older than the socket's.
void CanTransport::count_drops(std::uint32_t drops) noexcept {
  const std::uint32_t more = drops - drops_;
  if (more == 0 || more > UINT32_MAX / 2) return;
  counters_.kernel_drops.add(more);
  drops_ = drops;
}

std::span<const ifog_can_frame> CanTransport::accept(std::size_t received, std::int64_t read_at) noexcept {
  std::size_t kept = 0;
  stamps_.begin(realtime_ns(), read_at);
  for (std::size_t i = 0; i < received; ++i) {
    const ReceiveControl said = batch_.control(i);
    if (said.has_drops) count_drops(said.drops);
    ifog_can_frame& frame = frames_[kept];
    switch (from_socket(raw_[i], batch_.length(i), frame)) {
      case CanKind::data:
        frame.arrival_ns = said.arrival_ns != 0 ? stamps_.on_arrival_clock(said.arrival_ns) : read_at;
        ++kept;
        break;
      case CanKind::error:
        counters_.error_frames.add(1);
        break;
      case CanKind::remote:
      case CanKind::unknown:
        break;
    }
  }
  return std::span<const ifog_can_frame>(frames_).first(kept);
}

}  // namespace

std::unique_ptr<Transport> make_can_transport(const CanSettings& settings) {
  return std::make_unique<CanTransport>(settings);
}

}  // namespace ifog

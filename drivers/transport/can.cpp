#include "drivers/transport/can.h"
#include "drivers/transport/clock.h"

#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>

#include "drivers/transport/can_socket.h"
#include "drivers/transport/receiving_socket.h"

namespace ifog {
namespace {

constexpr std::size_t kBatch = 64;  // frames a system call

class CanTransport final : public Transport {
 public:
  explicit CanTransport(const CanSettings& settings) : Transport(settings.interface), settings_(settings) {
    for (std::size_t i = 0; i < kBatch; ++i) {
      vectors_[i] = {&raw_[i], sizeof raw_[i]};
      messages_[i].msg_hdr.msg_iov = &vectors_[i];
      messages_[i].msg_hdr.msg_iovlen = 1;
      messages_[i].msg_hdr.msg_control = control_[i].bytes;
    }
  }

 private:
  bool connect(std::string& warning, std::int64_t until_ns) override;
  Delivery receive(std::int64_t until_ns) noexcept override;
  std::span<const ifog_can_frame> accept(std::size_t received) noexcept;

  CanSettings settings_;
  CanSocket socket_;
  std::uint32_t drops_ = 0;
  KernelStamps stamps_;
  std::array<canfd_frame, kBatch> raw_{};
  std::array<iovec, kBatch> vectors_{};
  std::array<ControlRoom, kBatch> control_{};
  std::array<mmsghdr, kBatch> messages_{};
  std::array<ifog_can_frame, kBatch> frames_{};
};

bool CanTransport::connect(std::string& warning, std::int64_t /*until_ns*/) {
  if (!opening().empty())
    throw OpenError(name(), "cannot send the driver's opening bytes", EOPNOTSUPP,
                    "a driver without them on CAN");
  socket_.close();  // before another is opened: the interface may be a new one of the same name
  CanSocket fresh(settings_.interface);
  fresh.receive_only(settings_.ids, settings_.interface);
  socket_ = std::move(fresh);
  drops_ = 0;
  stamps_.begin(realtime_ns(), arrival_clock_ns());
  ask_for_drops(socket_.fd());
  ask_for_room(socket_.fd(), settings_.receive_buffer_bytes, name(), warning);
  ask_for_times(socket_.fd(), name(), warning);
  return true;
}

Delivery CanTransport::receive(std::int64_t until_ns) noexcept {
  short happened = 0;
  if (wait(socket_.fd(), POLLIN, until_ns, happened) != Wake::ready) return {};
  for (mmsghdr& message : messages_) {
    message.msg_hdr.msg_controllen = sizeof(ControlRoom);
    message.msg_hdr.msg_flags = 0;
  }
  const int n = recvmmsg(socket_.fd(), messages_.data(), kBatch, MSG_DONTWAIT, nullptr);
  if (n > 0) {
    Delivery delivery;
    delivery.frames = accept(static_cast<std::size_t>(n));
    return delivery;
  }
  const int error = n < 0 ? errno : ENODEV;
  if (error == EINTR || error == EAGAIN) return {};
  socket_.close();
  lost(error);  // ENETDOWN: set down; ENODEV: taken away
  return {};
}

std::span<const ifog_can_frame> CanTransport::accept(std::size_t received) noexcept {
  std::size_t kept = 0;
  const std::int64_t read_at = arrival_clock_ns();
  stamps_.begin(realtime_ns(), read_at);
  for (std::size_t i = 0; i < received; ++i) {
    const ReceiveControl said = receive_control(messages_[i].msg_hdr);
    if (said.has_drops) {
      kernel_drops_.add(said.drops - drops_);  // modulo 2^32, as the kernel counts
      drops_ = said.drops;
    }
    ifog_can_frame& frame = frames_[kept];
    switch (from_socket(raw_[i], messages_[i].msg_len, frame)) {
      case CanKind::data:
        frame.arrival_ns = said.arrival_ns != 0 ? stamps_.on_arrival_clock(said.arrival_ns) : read_at;
        ++kept;
        break;
      case CanKind::error:
        error_frames_.add(1);
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

// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/serial/serial_port.h"

#include <libserialport.h>
#include <linux/serial.h>
#include <sys/ioctl.h>

#include <array>
#include <cerrno>
#include <climits>
#include <string>
#include <system_error>

#include "drivers/transport/sole_reader.h"

namespace ifog {
namespace {

// libserialport has the system's errno only for SP_ERR_FAIL.
int error_of(sp_return result) {
  switch (result) {
    case SP_ERR_FAIL:
      return sp_last_error_code() != 0 ? sp_last_error_code() : EIO;
    case SP_ERR_MEM:
      return ENOMEM;
    case SP_ERR_SUPP:
      return EOPNOTSUPP;
    default:
      return EINVAL;
  }
}

// Line settings as text: 921600 8N1.
std::string written(const SerialSettings& s) {
  const char* const letter = "NEO";
  return std::to_string(s.baud) + " " + std::to_string(s.data_bits) + letter[static_cast<int>(s.parity)] +
         std::to_string(s.stop_bits);
}

class LibSerialPort final : public SerialPort {
 public:
  LibSerialPort(const SerialSettings& settings, std::string& warning);
  ~LibSerialPort() override {
    if (open_) sp_close(port_);
    sp_free_port(port_);
  }
  LibSerialPort(const LibSerialPort&) = delete;
  LibSerialPort& operator=(const LibSerialPort&) = delete;
  [[nodiscard]] int fd() const override { return fd_; }

 private:
  void check(sp_return result, const std::string& what, const std::string& expected) const {
    if (result != SP_OK) throw OpenError(device_, what, error_of(result), expected);
  }
  void set_driver_options(const SerialSettings& settings, std::string& warning) const;
  void verify(const SerialSettings& settings) const;

  std::string device_;
  sp_port* port_;
  bool open_ = false;
  int fd_ = -1;
};

sp_port* find_port(const std::string& device) {
  std::array<char, PATH_MAX> resolved{};
  // libserialport needs kernel names.
  if (realpath(device.c_str(), resolved.data()) == nullptr)
    throw OpenError(device, "cannot open", errno, "a serial device");
  sp_port* port = nullptr;
  const sp_return result = sp_get_port_by_name(resolved.data(), &port);
  if (result != SP_OK) throw OpenError(device, "cannot open", error_of(result), "a serial device");
  return port;
}

LibSerialPort::LibSerialPort(const SerialSettings& settings, std::string& warning)
    : device_(settings.device), port_(find_port(settings.device)) {
  try {
    check(sp_open(port_, SP_MODE_READ_WRITE), "cannot open",
          "a serial device that this user may read and write");
    open_ = true;
    check(sp_get_port_handle(port_, &fd_), "cannot open", "a file descriptor");
    // The kernel's exclusive mode does not apply to root.
    claim(fd_, device_);
    ioctl(fd_, TIOCEXCL);
    set_driver_options(settings, warning);
    constexpr std::array kParity{SP_PARITY_NONE, SP_PARITY_EVEN, SP_PARITY_ODD};
    const std::string what = "cannot set " + written(settings);
    check(sp_set_baudrate(port_, static_cast<int>(settings.baud)), what, "a speed the device can do");
    check(sp_set_bits(port_, static_cast<int>(settings.data_bits)), what, "5 to 8 data bits");
    check(sp_set_parity(port_, kParity.at(static_cast<std::size_t>(settings.parity))), what,
          "a parity the device can do");
    check(sp_set_stopbits(port_, static_cast<int>(settings.stop_bits)), what, "1 or 2 stop bits");
    check(sp_set_flowcontrol(port_, SP_FLOWCONTROL_NONE), what, "a line without flow control");
    verify(settings);
    // Earlier bytes would get a wrong arrival time.
    check(sp_flush(port_, SP_BUF_INPUT), "cannot discard old input", "a serial device");
  } catch (...) {
    if (open_) sp_close(port_);
    sp_free_port(port_);
    throw;
  }
}

void LibSerialPort::set_driver_options(const SerialSettings& settings, std::string& warning) const {
  serial_struct driver{};
  const bool known = ioctl(fd_, TIOCGSERIAL, &driver) == 0;
  if (settings.baud_base != 0) {
    if (!known) throw OpenError(device_, "cannot set baud_base", errno, "a driver that knows TIOCSSERIAL");
    driver.baud_base = static_cast<int>(settings.baud_base);
    if (ioctl(fd_, TIOCSSERIAL, &driver) != 0)
      throw OpenError(device_, "cannot set baud_base " + std::to_string(settings.baud_base), errno,
                      "CAP_SYS_ADMIN and a driver that lets it be set");
  }
  // USB adapters otherwise collect bytes for up to 16 ms.
  driver.flags |= ASYNC_LOW_LATENCY;
  if (!known || ioctl(fd_, TIOCSSERIAL, &driver) != 0)
    warning = device_ + ": low latency is not available (" + std::generic_category().message(errno) +
              "): bytes may arrive late and in lumps";
}

void LibSerialPort::verify(const SerialSettings& settings) const {
  sp_port_config* raw = nullptr;
  check(sp_new_config(&raw), "cannot read the line's settings", "memory");
  const std::unique_ptr<sp_port_config, void (*)(sp_port_config*)> config(raw, sp_free_config);
  check(sp_get_config(port_, raw), "cannot read the line's settings", "a serial device");
  int baud = 0, bits = 0, stop = 0;
  check(sp_get_config_baudrate(raw, &baud), "cannot read the speed", "a serial device");
  check(sp_get_config_bits(raw, &bits), "cannot read the data bits", "a serial device");
  check(sp_get_config_stopbits(raw, &stop), "cannot read the stop bits", "a serial device");
  const auto wanted = static_cast<std::int64_t>(settings.baud);
  if (std::llabs(baud - wanted) * 50 > wanted)
    throw OpenError(
        device_, "asked for " + std::to_string(wanted) + " baud, the device went to " + std::to_string(baud),
        EINVAL, "within 2 % of the asked speed (baud_base may need to be set)");
  if (bits != static_cast<int>(settings.data_bits) || stop != static_cast<int>(settings.stop_bits))
    throw OpenError(device_,
                    "asked for " + written(settings) + ", the device has " + std::to_string(bits) +
                        " data and " + std::to_string(stop) + " stop bits",
                    EINVAL, "the line as asked for");
}

}  // namespace

bool SerialPort::errors(LineErrors& out) const noexcept {
  serial_icounter_struct counted{};
  if (ioctl(fd(), TIOCGICOUNT, &counted) != 0) return false;
  // The kernel's counters are ints that wrap.
  const auto sum = [](auto... counts) { return (static_cast<std::uint32_t>(counts) + ...); };
  out.lost = sum(counted.overrun, counted.buf_overrun);
  out.damaged = sum(counted.frame, counted.parity, counted.brk);
  return true;
}

std::unique_ptr<SerialPort> open_serial_port(const SerialSettings& settings, std::string& warning) {
  return std::make_unique<LibSerialPort>(settings, warning);
}

}  // namespace ifog

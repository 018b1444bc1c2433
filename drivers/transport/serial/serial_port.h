// SPDX-License-Identifier: Apache-2.0
// A serial line as libserialport opens it, set up and checked.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace ifog {

struct SerialSettings {
  enum class Parity { none, even, odd };

  std::string device;  // a udev symlink will do
  std::uint32_t baud = 0;
  std::uint32_t data_bits = 8;
  Parity parity = Parity::none;
  std::uint32_t stop_bits = 1;
  // The UART's clock / 16 where the driver has it wrong, as setserial's baud_base: a speed above it is
  // otherwise not reached. 0: leave it. Needs CAP_SYS_ADMIN.
  std::uint32_t baud_base = 0;
  // Lines that set the device up, each answered, see SetUpDialogue; none: nothing is sent.
  std::vector<std::string> set_up{};

  bool operator==(const SerialSettings&) const = default;
};

// What went wrong on a line since its driver was loaded, as TIOCGICOUNT tells it, modulo 2^32.
struct LineErrors {
  std::uint32_t lost = 0;     // bytes that the UART or the kernel's buffer had no room for
  std::uint32_t damaged = 0;  // wrong framing or parity; a break is a framing error all along
};

// Owns the line; closed with it.
class SerialPort {
 public:
  virtual ~SerialPort() = default;
  [[nodiscard]] virtual int fd() const = 0;  // non-blocking
  // False: the driver does not count, or the device is gone.
  virtual bool errors(LineErrors& out) const noexcept;
};

// Throws OpenError; `warning` gets what was asked for but can be done without.
using SerialOpener = std::function<std::unique_ptr<SerialPort>(const SerialSettings&, std::string& warning)>;

// Raw, no flow control, old input discarded. The speed is read back, and one that is more than 2 % off (the
// most an asynchronous line of 10 bits bears) refused: some UARTs silently stay at another.
std::unique_ptr<SerialPort> open_serial_port(const SerialSettings& settings, std::string& warning);

}  // namespace ifog

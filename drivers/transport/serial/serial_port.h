// SPDX-License-Identifier: Apache-2.0
// A serial line opened by libserialport, set up and checked.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/transport/transport.h"

namespace ifog {

struct SerialSettings {
  enum class Parity { none, even, odd };

  std::string device;  // may be a udev symlink
  std::uint32_t baud = 0;
  std::uint32_t data_bits = 8;
  Parity parity = Parity::none;
  std::uint32_t stop_bits = 1;
  // UART clock / 16 if the driver assumes a wrong one, as setserial's baud_base; needed for higher speeds. 0:
  // unchanged. Needs CAP_SYS_ADMIN.
  std::uint32_t baud_base = 0;
  // Lines that set the device up, each with an answer (SetUpDialogue); empty: none.
  std::vector<std::string> set_up{};

  bool operator==(const SerialSettings&) const = default;
};

// Errors of a line since its driver was loaded (TIOCGICOUNT), modulo 2^32.
struct LineErrors {
  std::uint32_t lost = 0;     // overruns of UART or kernel buffer, bytes
  std::uint32_t damaged = 0;  // framing or parity errors; a break is a continuous framing error
};

// Owns and closes the line.
class SerialPort {
 public:
  virtual ~SerialPort() = default;
  [[nodiscard]] virtual int fd() const = 0;  // non-blocking
  // False: the driver does not count, or the device is gone.
  virtual bool errors(LineErrors& out) const noexcept;
};

// Throws OpenError; `warning` gets what was not granted but is not essential.
using SerialOpener = std::function<std::unique_ptr<SerialPort>(const SerialSettings&, std::string& warning)>;

// Raw, no flow control, old input discarded. The speed is read back and rejected if more than 2 % off (limit
// of an asynchronous 10-bit line), as some UARTs silently keep another.
std::unique_ptr<SerialPort> open_serial_port(const SerialSettings& settings, std::string& warning);

// Serial transport, which reopens a returning line within about 0.1 s.
// Arrival times are read right after the bytes. Overruns of UART and kernel are counted as kernel drops,
// framing and parity errors and breaks as error frames, if the driver reports them (TIOCGICOUNT): ten times a
// second, at a hang-up and after the last read. With `set_up` the device is set up whenever the line opens,
// and after a silence of more than a second (power may have been off). A wrong or missing answer counts as a
// failed opening. `open_port` is for tests, as libserialport accepts no pseudo terminal.
std::unique_ptr<Transport> make_serial_transport(const SerialSettings& settings,
                                                 SerialOpener open_port = open_serial_port);

}  // namespace ifog

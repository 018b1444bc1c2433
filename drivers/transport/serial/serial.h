// SPDX-License-Identifier: Apache-2.0
// The serial transport. Opens the line again whenever it goes away, within about a tenth of a second of
// its return.
#pragma once

#include <memory>

#include "drivers/transport/serial/serial_port.h"
#include "drivers/transport/transport.h"

namespace ifog {

// Arrival times are read right after the bytes. Overruns of the UART and of the kernel's buffer are counted
// as kernel drops, framing and parity errors and breaks as error frames, where the driver tells them
// (TIOCGICOUNT): ten times a second, when the line hangs up and after the last read.
// With `set_up` the device is set up whenever the line opens, and again when it has been silent for over a
// second: its power may have been off. An answer that differs, or none, is as a line that cannot be opened.
// `open_port` is there for tests: libserialport accepts no pseudo terminal. Throws std::runtime_error on
// settings outside what a line can be.
std::unique_ptr<Transport> make_serial_transport(const SerialSettings& settings,
                                                 SerialOpener open_port = open_serial_port);

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// Serial transport. Reopens a returning line within about 0.1 s.
#pragma once

#include <memory>

#include "drivers/transport/serial/serial_port.h"
#include "drivers/transport/transport.h"

namespace ifog {

// Arrival times are read right after the bytes. Overruns of UART and kernel are counted as kernel drops,
// framing and parity errors and breaks as error frames, if the driver reports them (TIOCGICOUNT): ten times a
// second, at a hang-up and after the last read. With `set_up` the device is set up whenever the line opens,
// and after a silence of more than a second (power may have been off). A wrong or missing answer counts as a
// failed opening. `open_port` is for tests, as libserialport accepts no pseudo terminal.
std::unique_ptr<Transport> make_serial_transport(const SerialSettings& settings,
                                                 SerialOpener open_port = open_serial_port);

}  // namespace ifog

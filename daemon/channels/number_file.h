// SPDX-License-Identifier: Apache-2.0
// A file that holds one number and nothing else: hwmon, thermal zones, IIO.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "daemon/channels/channel_fault.h"

namespace ifog {

// The number, or why there is none. Blanks and line ends may stand around it; every other character that is
// not of the number makes it none: half of "21,5" is no measurement.
std::variant<double, ChannelFault> number_in(std::string_view text);
// The same of a file's text. Never waits: a FIFO in the place of the file would hold up every other channel,
// and the end of the daemon.
std::variant<double, ChannelFault> read_number_file(const std::string& path);

}  // namespace ifog

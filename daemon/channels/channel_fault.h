// SPDX-License-Identifier: Apache-2.0
// Reason why a channel has no new value, as plain data for any thread; housekeeping makes the text.
#pragma once

#include <cstdint>
#include <string>

#include "daemon/config/config.h"

namespace ifog {

struct ChannelFault {
  enum class Kind : std::uint8_t {
    silent,        // nothing was received, or nothing more
    unreadable,    // file: opening or reading failed with `error`
    no_file,       // file: a folder, FIFO or device
    empty,         // file: empty
    no_number,     // file: not a single number
    no_message,    // lcm: a message of a type without values
    no_field,      // lcm: the message does not have the field
    late,          // lcm: older than the last value
    clock_behind,  // lcm: the sender's clock is behind by `error` seconds
    impossible,    // the value is outside its possible range
  };
  Kind kind = Kind::silent;
  int error = 0;  // errno; clock_behind: s

  bool operator==(const ChannelFault&) const = default;
};

// One line: the channel, its source, the fault, what was expected.
std::string describe(const ChannelConfig& channel, const ChannelFault& fault);

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// Why a channel has no new value, as plain data that any thread may leave and housekeeping words.
#pragma once

#include <cstdint>
#include <string>

#include "daemon/config/config.h"

namespace ifog {

struct ChannelFault {
  enum class Kind : std::uint8_t {
    silent,        // nothing has come, or nothing more
    unreadable,    // file: opening or reading it failed, error
    no_file,       // file: a folder, a FIFO, a device
    empty,         // file: holds nothing
    no_number,     // file: holds something else, or more
    no_message,    // lcm: what came is no message of the types that carry values
    no_field,      // lcm: what came is one, without the field
    late,          // lcm: older than the value that is held
    clock_behind,  // lcm: values come, dated by a clock that is behind by error seconds
    impossible,    // the value is beyond what it can be
  };
  Kind kind = Kind::silent;
  int error = 0;  // errno; clock_behind: s

  bool operator==(const ChannelFault&) const = default;
};

// One line: the channel, where it should come from, what is wrong there, what was expected.
std::string describe(const ChannelConfig& channel, const ChannelFault& fault);

}  // namespace ifog

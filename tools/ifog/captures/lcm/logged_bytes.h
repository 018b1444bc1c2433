// SPDX-License-Identifier: Apache-2.0
// Bytes of a device that another program received and published on LCM, out of a log, through a driver of ours:
// senlcm.raw_t, bot_core.raw_t (the same members) and senlcm.raw_ascii_t, see msgs/peers.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "drivers/capture/files/input_file.h"
#include "drivers/capture/recording.h"
#include "drivers/host/driver_instance.h"

namespace ifog::tools {

bool carries_bytes(std::span<const std::uint8_t> message);

// channel empty: the only one that carries bytes. They arrive at the time in their message. Throws
// std::runtime_error with one line: no such channel, several where none was chosen, another type on it, or a
// driver that takes CAN frames only.
RecordingCounts decode_logged_bytes(InputFile& file, DriverInstance& driver, const std::string& channel,
                                    const std::function<void(const ifog_sample&)>& sink);

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
// The messages of a log made by lcm-logger or of a flight recording made by `ifog record`, as rows of what
// the sensor measured.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "drivers/capture/files/input_file.h"
#include "drivers/capture/recording.h"
#include "drivers/capture/times/row_sink.h"
#include "drivers/host/driver_instance.h"

namespace ifog::tools {

// `channel` empty: the log's only IFOG_… channel with rates, or else its only one of a type of
// peer_reader.h. Time is the sensor's own clock where it has one, else the fitted time, counted from the
// first message. Environment channels are those of the sensor's status and of ifog.channel_t, see
// lcm_channels.h. Throws std::runtime_error with one line: no log, no such channel (those there are named),
// several where none was chosen, a message that is no rate_t, time that does not go on.
void read_lcm_log(InputFile& file, const std::string& channel, RowSink& sink);

// What the daemon published, in the columns of `ifog denoise`: raw, compensated and denoised rate and
// variance by axis. Throws as above.
void read_published(InputFile& file, const std::string& channel, RowSink& sink);

// Bytes of a device that another program received and published on LCM, out of a log, through a driver of ours:
// senlcm.raw_t, bot_core.raw_t (the same members) and senlcm.raw_ascii_t, see msgs/peers.
bool carries_bytes(std::span<const std::uint8_t> message);

// channel empty: the only one that carries bytes. They arrive at the time in their message. Throws
// std::runtime_error with one line: no such channel, several where none was chosen, another type on it, or a
// driver that takes CAN frames only.
RecordingCounts decode_logged_bytes(InputFile& file, DriverInstance& driver, const std::string& channel,
                                    const std::function<void(const ifog_sample&)>& sink);

}  // namespace ifog::tools

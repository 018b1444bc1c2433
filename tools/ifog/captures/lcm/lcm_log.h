// SPDX-License-Identifier: Apache-2.0
// Reads the messages of a log of lcm-logger, or of a flight recording of `ifog record`, as rows of a capture.
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

// `channel` empty: the only IFOG_… channel with rates, or else the only one of a type in peer_reader.h. Time
// is the sensor's clock if it has one, otherwise the fitted time, since the first message. Environment
// channels: see lcm_channels.h. Throws std::runtime_error with one line: not a log, no such channel (lists
// those there are), several channels without a choice, a message that is not a rate_t, time that does not
// advance.
void read_lcm_log(InputFile& file, const std::string& channel, RowSink& sink);

// Reads published rates as the columns of `ifog denoise`: raw, compensated and denoised rate and variance by
// axis. Throws as above.
void read_published(InputFile& file, const std::string& channel, RowSink& sink);

// True for a device's bytes published by another program, which a driver decodes: senlcm.raw_t,
// bot_core.raw_t (same members) and senlcm.raw_ascii_t, see msgs/peers.
bool carries_bytes(std::span<const std::uint8_t> message);

// channel empty: the only one with bytes. Arrival times are those in the messages. Throws std::runtime_error
// with one line: no such channel, several without a choice, another type on it, or a driver for CAN frames.
RecordingCounts decode_logged_bytes(InputFile& file, DriverInstance& driver, const std::string& channel,
                                    const std::function<void(const ifog_sample&)>& sink);

}  // namespace ifog::tools

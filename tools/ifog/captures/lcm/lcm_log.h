// SPDX-License-Identifier: Apache-2.0
// The messages of a log made by lcm-logger or of a flight recording made by `ifog record`, as rows of what
// the sensor measured.
#pragma once

#include <string>

#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog::tools {

// `channel` empty: the log's only IFOG_… channel with rates, or else its only one of a type of peer_types.h.
// Time is the sensor's own clock where it has one, else the fitted time, counted from the first message. Environment channels are those of the sensor's status
// and of ifog.channel_t, see lcm_channels.h. Throws std::runtime_error with one line: no log, no such channel
// (those there are named), several where none was chosen, a message that is no rate_t, time that does not go
// on.
void read_lcm_log(InputFile& file, const std::string& channel, RowSink& sink);

// What the daemon published, in the columns of `ifog denoise`: raw, compensated and denoised rate and
// variance by axis. Throws as above.
void read_published(InputFile& file, const std::string& channel, RowSink& sink);

}  // namespace ifog::tools

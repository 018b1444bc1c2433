// SPDX-License-Identifier: Apache-2.0
#include "daemon/channels/can_channel.h"

#include <filesystem>
#include <stdexcept>

#include "drivers/capture/files/input_file.h"
#include "drivers/dbc/codec.h"
#include "drivers/ifog/quoted.h"

namespace ifog {

CanChannel::CanChannel(const std::string& dbc_file, const std::string& signal, const std::string& column) {
  std::error_code ignored;
  if (std::filesystem::exists(dbc_file, ignored) && !std::filesystem::is_regular_file(dbc_file, ignored))
    throw std::runtime_error(dbc_file + ": is no regular file, expected a DBC file");
  const dbc::Database database = dbc::parse_database(read_whole_file(dbc_file), dbc_file);
  const std::vector<dbc::SignalInMessage> found = dbc::find_signals(database, signal);
  if (found.empty())
    throw std::runtime_error(
        dbc_file + ": no signal \"" + printable(signal) + "\"; expected SIGNAL or MESSAGE.SIGNAL" +
        (database.warnings.empty() ? "" : " (a bad line: " + database.warnings.front() + ")"));
  if (found.size() > 1)
    throw std::runtime_error(dbc_file + ": signal \"" + printable(signal) +
                             "\" is in several messages; expected MESSAGE.SIGNAL");
  dbc::check_fits(database, *found.front().message, *found.front().signal);
  message_ = *found.front().message;
  signal_ = static_cast<std::size_t>(found.front().signal - found.front().message->signals.data());
  if (!column.empty()) to_column_ = convert_to_column(found.front().signal->unit, column, remark_);
}

CanChannel can_channel(const ChannelConfig& channel) {
  try {
    const bool own_unit = channel.scale != 1.0 || channel.offset != 0.0;
    return {channel.dbc, channel.signal, own_unit ? "" : channel.name};
  } catch (const std::exception& error) {
    const bool of_signal = std::string(error.what()).find(": signal \"") != std::string::npos ||
                           std::string(error.what()).find(": no signal \"") != std::string::npos;
    throw KeyError("channel." + channel.name + (of_signal ? ".signal" : ".dbc"), error.what());
  }
}

bool CanChannel::decode(const ifog_can_frame& frame, double& value) const noexcept {
  if (frame.id != message_.id || ((frame.flags & IFOG_CAN_EXTENDED) != 0) != message_.extended) return false;
  const dbc::Signal& signal = message_.signals[signal_];
  const std::span<const std::uint8_t> data(frame.data, frame.length);
  if (data.size() < dbc::bytes_needed(signal) || !dbc::selected(message_, signal, data)) return false;
  value = dbc::physical(signal, dbc::raw_bits(signal, data)) * to_column_.scale + to_column_.offset;
  return true;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "daemon/channels/can_channel.h"

#include <filesystem>
#include <stdexcept>

#include "drivers/capture/files/input_file.h"
#include "drivers/dbc/codec.h"
#include "drivers/ifog/quoted.h"

namespace ifog {

CanChannel::CanChannel(const ChannelConfig& channel) {
  std::string key = ".dbc";
  try {
    std::error_code ignored;
    const std::string& file = channel.dbc;
    if (std::filesystem::exists(file, ignored) && !std::filesystem::is_regular_file(file, ignored))
      throw std::runtime_error(file + ": is no regular file, expected a DBC file");
    const dbc::Database database = dbc::parse_database(read_whole_file(file), file);
    key = ".signal";
    const std::vector<dbc::SignalInMessage> found = dbc::find_signals(database, channel.signal);
    if (found.empty())
      throw std::runtime_error(
          file + ": no signal \"" + printable(channel.signal) + "\"; expected SIGNAL or MESSAGE.SIGNAL" +
          (database.warnings.empty() ? "" : " (a bad line: " + database.warnings.front() + ")"));
    if (found.size() > 1)
      throw std::runtime_error(file + ": signal \"" + printable(channel.signal) +
                               "\" is in several messages; expected MESSAGE.SIGNAL");
    const auto& [message, signal] = found.front();
    dbc::check_fits(database, *message, *signal);
    message_ = *message;
    signal_ = static_cast<std::size_t>(signal - message->signals.data());
    if (channel.scale == 1.0 && channel.offset == 0.0)
      to_column_ = convert_to_column(signal->unit, channel.name, remark_);
  } catch (const std::exception& error) {
    throw KeyError("channel." + channel.name + key, error.what());
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

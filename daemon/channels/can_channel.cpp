#include "daemon/channels/can_channel.h"

#include <stdexcept>

#include "drivers/capture/text_file.h"
#include "drivers/dbc/codec.h"

namespace ifog {

CanChannel::CanChannel(const std::string& dbc_file, const std::string& signal) {
  const dbc::Database database = dbc::parse_database(read_text_file(dbc_file), dbc_file);
  int found = 0;
  for (const dbc::Message& message : database.messages)
    for (std::size_t i = 0; i < message.signals.size(); ++i)
      if (message.signals[i].name == signal || message.name + "." + message.signals[i].name == signal) {
        dbc::check_fits(database, message, message.signals[i]);
        message_ = message;
        signal_ = i;
        ++found;
      }
  if (found == 0)
    throw std::runtime_error(dbc_file + ": no signal \"" + signal + "\"; expected SIGNAL or MESSAGE.SIGNAL");
  if (found > 1)
    throw std::runtime_error(dbc_file + ": signal \"" + signal +
                             "\" is in several messages; expected MESSAGE.SIGNAL");
}

bool CanChannel::decode(const ifog_can_frame& frame, double& value) const noexcept {
  if (frame.id != message_.id || ((frame.flags & IFOG_CAN_EXTENDED) != 0) != message_.extended) return false;
  const dbc::Signal& signal = message_.signals[signal_];
  const std::span<const std::uint8_t> data(frame.data, frame.length);
  if (data.size() < dbc::bytes_needed(signal) || !dbc::selected(message_, signal, data)) return false;
  value = dbc::physical(signal, dbc::raw_bits(signal, data));
  return true;
}

}  // namespace ifog

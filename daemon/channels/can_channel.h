// SPDX-License-Identifier: Apache-2.0
// One signal of a DBC file as an environment channel.
#pragma once

#include <string>

#include "daemon/config/config.h"
#include "drivers/dbc/database.h"
#include "drivers/ifog/driver.h"
#include "drivers/transport/file/file.h"

namespace ifog {

class CanChannel {
 public:
  // signal: "SIGNAL" or "MESSAGE.SIGNAL". Throws std::runtime_error with one line: the file, a signal that is
  // not there or is in several messages.
  CanChannel(const std::string& dbc_file, const std::string& signal);

  [[nodiscard]] CanId id() const { return {message_.id, message_.extended}; }
  // False: the frame does not carry the signal. NaN: beyond the range the file states.
  bool decode(const ifog_can_frame& frame, double& value) const noexcept;

 private:
  dbc::Message message_;
  std::size_t signal_ = 0;
};

// As configured; throws KeyError, of the key in the sensor that the complaint is due to.
CanChannel can_channel(const ChannelConfig& channel);

}  // namespace ifog

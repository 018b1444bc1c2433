// SPDX-License-Identifier: Apache-2.0
// Environment channel from one signal of a DBC file.
#pragma once

#include <string>

#include "daemon/config/config.h"
#include "drivers/dbc/database.h"
#include "drivers/ifog/driver.h"
#include "drivers/transport/file/file.h"

namespace ifog {

class CanChannel {
 public:
  // signal: "SIGNAL" or "MESSAGE.SIGNAL". Throws std::runtime_error with one line: an error of the file, a
  // signal that is missing or in several messages.
  CanChannel(const std::string& dbc_file, const std::string& signal);

  [[nodiscard]] CanId id() const { return {message_.id, message_.extended}; }
  // False: the frame does not carry the signal. NaN: outside the range in the file.
  bool decode(const ifog_can_frame& frame, double& value) const noexcept;

 private:
  dbc::Message message_;
  std::size_t signal_ = 0;
};

// As configured; throws KeyError with the sensor's key that causes the error.
CanChannel can_channel(const ChannelConfig& channel);

}  // namespace ifog

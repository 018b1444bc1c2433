// SPDX-License-Identifier: Apache-2.0
// Environment channel from one signal of a DBC file.
#pragma once

#include <string>

#include "daemon/config/config.h"
#include "drivers/dbc/database.h"
#include "drivers/ifog/driver.h"
#include "drivers/transport/file/file.h"
#include "drivers/units/units.h"

namespace ifog {

class CanChannel {
 public:
  // signal: "SIGNAL" or "MESSAGE.SIGNAL". Throws std::runtime_error with one line: an error of the file, a
  // signal that is missing or in several messages.
  // column: values are converted from the file's unit to the one in which this name ends; "": used as they are.
  CanChannel(const std::string& dbc_file, const std::string& signal, const std::string& column = "");

  [[nodiscard]] CanId id() const { return {message_.id, message_.extended}; }
  // A line on a unit that could not be converted, or "".
  [[nodiscard]] const std::string& remark() const { return remark_; }
  // False: the frame does not carry the signal. NaN: outside the range in the file.
  bool decode(const ifog_can_frame& frame, double& value) const noexcept;

 private:
  dbc::Message message_;
  std::size_t signal_ = 0;
  UnitConversion to_column_;
  std::string remark_;
};

// As configured; a scale or offset there stands for the file's unit. Throws KeyError with the sensor's key that causes the error.
CanChannel can_channel(const ChannelConfig& channel);

}  // namespace ifog

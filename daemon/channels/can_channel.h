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
  // Values are in the unit of the channel's name; a configured scale or offset stands for the file's unit. Throws
  // KeyError with one line and the sensor's key: an error of the file, a signal that is missing or in several
  // messages.
  explicit CanChannel(const ChannelConfig& channel);

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

}  // namespace ifog

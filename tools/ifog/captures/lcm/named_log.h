// SPDX-License-Identifier: Apache-2.0
// A log of LCM messages under a name, because it is read several times. One that comes packed, through a pipe or as a
// flight recording is kept in a file without a name of its own, which only this process knows.
#pragma once

#include <optional>
#include <string>

#include "drivers/capture/files/input_file.h"
#include "drivers/system/unnamed_file.h"

namespace ifog::tools {

class NamedLog {
 public:
  // Throws std::runtime_error with one line: no room for it, or it cannot be read.
  explicit NamedLog(InputFile& file);
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  void unpack(InputFile& file);
  void unpack_messages(InputFile& file) const;

  std::string name_;
  std::optional<UnnamedFile> unpacked_;
};

// Whether a file is a flight recording that holds LCM messages. It looks at the file's head and reads nothing.
bool recorded_messages(const InputFile& file);

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
// Shows the progress of reading a file, in bytes.
#pragma once

#include <filesystem>

#include "drivers/capture/files/input_file.h"
#include "tools/ifog/console/progress.h"

namespace ifog::tools {

class ReadingProgress {
 public:
  // The file must outlive this.
  explicit ReadingProgress(InputFile& file, const char* what = "reading")
      : file_(file), progress_(what + (" " + std::filesystem::path(file.path()).filename().string()), 0) {
    file_.report_to(progress_.teller());
  }
  ~ReadingProgress() { file_.report_to({}); }
  ReadingProgress(const ReadingProgress&) = delete;
  ReadingProgress& operator=(const ReadingProgress&) = delete;

 private:
  InputFile& file_;
  Progress progress_;
};

}  // namespace ifog::tools

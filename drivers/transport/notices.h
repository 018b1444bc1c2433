// SPDX-License-Identifier: Apache-2.0
// What opening a device said, for one line in the log. Any thread; the mutex is locked when a device opens, never while
// it is read.
#pragma once

#include <mutex>
#include <string>
#include <utility>

namespace ifog {

class Notices {
 public:
  // What the device did not grant and can do without; "" for nothing.
  void keep_warning(std::string&& warning) {
    const std::lock_guard lock(mutex_);
    new_warning_ = new_warning_ || (!warning.empty() && warning != warning_);
    warning_ = std::move(warning);
  }
  // Each text once, however often the device is opened again with the same; "" when there is nothing new.
  [[nodiscard]] std::string take_warning() {
    const std::lock_guard lock(mutex_);
    return std::exchange(new_warning_, false) ? warning_ : std::string();
  }
  // How the device has answered to its set-up.
  void keep_answers(const std::string& answers) {
    const std::lock_guard lock(mutex_);
    answers_ = answers;
  }
  // Once each time; "" for nothing new.
  [[nodiscard]] std::string take_answers() {
    const std::lock_guard lock(mutex_);
    return std::exchange(answers_, {});
  }

 private:
  std::mutex mutex_;
  std::string warning_, answers_;
  bool new_warning_ = false;
};

}  // namespace ifog

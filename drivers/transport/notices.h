// SPDX-License-Identifier: Apache-2.0
// Messages from opening a device, for the log. Thread-safe; the mutex is used when a device opens, never
// while it is read.
#pragma once

#include <mutex>
#include <string>
#include <utility>

namespace ifog {

class Notices {
 public:
  // What the device did not grant but is not essential; "" for nothing.
  void keep_warning(std::string&& warning) {
    const std::lock_guard lock(mutex_);
    new_warning_ = new_warning_ || (!warning.empty() && warning != warning_);
    warning_ = std::move(warning);
  }
  // Returns each text once, even if the device is reopened with the same; "" if there is nothing new.
  [[nodiscard]] std::string take_warning() {
    const std::lock_guard lock(mutex_);
    return std::exchange(new_warning_, false) ? warning_ : std::string();
  }
  // The device's answers to its set-up.
  void keep_answers(const std::string& answers) {
    const std::lock_guard lock(mutex_);
    answers_ = answers;
  }
  // Returns them once each time; "" if there is nothing new.
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

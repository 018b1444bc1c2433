// SPDX-License-Identifier: Apache-2.0
// A progress bar with the time left, for work longer than one second, on a terminal only.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <thread>

#include "drivers/capture/files/input_file.h"

namespace ifog::tools {

class Progress {
 public:
  using Clock = std::chrono::steady_clock;

  // total: number of steps, rows or bytes; 0: unknown, then the elapsed time is shown.
  Progress(const std::string& what, std::size_t total);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  // From any thread and as often as wanted. `total` may become known here.
  void at(std::size_t done) { done_ = done; }
  void at(std::size_t done, std::size_t total) {
    total_ = total;
    done_ = done;
  }

  // For functions that report progress through a callback.
  [[nodiscard]] std::function<void(std::size_t done, std::size_t total)> teller();

 private:
  void redraw(const std::stop_token& end) noexcept;
  void draw(Clock::time_point now, Clock::time_point step, std::size_t done) const;

  Progress* const outer_;  // the bar that this one replaces while it lives
  const std::string what_;
  const Clock::time_point start_;
  std::atomic<std::size_t> done_ = 0, total_;
  std::jthread drawing_;  // at a terminal
};

// "12 s left", "4 min left", "1 h 20 min left", at the average speed so far. "" before 5 % or 2 s, and after
// the predicted end.
std::string time_left(double until_step_s, double since_step_s, std::size_t done, std::size_t total);

// Removes the bar before other text is printed.
void clear_progress();

// Shows the progress of reading a file, in bytes.
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

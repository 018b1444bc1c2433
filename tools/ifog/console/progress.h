// SPDX-License-Identifier: Apache-2.0
// A progress bar with the time left, for work longer than one second, on a terminal only.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace ifog::tools {

class Progress {
 public:
  using Clock = std::chrono::steady_clock;

  // redraw: a thread redraws during long steps. nothing: no thread, if one would disturb.
  enum class Between { redraw, nothing };

  // total: number of steps, rows or bytes; 0: unknown, then the elapsed time is shown.
  Progress(const std::string& what, std::size_t total, Between between = Between::redraw);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  // Cheap: redraws at most ten times per second. `total` may become known here.
  void at(std::size_t done) { at(done, total_); }
  void at(std::size_t done, std::size_t total);

  // For functions that report progress through a callback.
  [[nodiscard]] std::function<void(std::size_t done, std::size_t total)> teller();

 private:
  void draw(Clock::time_point now);
  void redraw_between() noexcept;

  Progress* const outer_;  // the bar that this one replaces while it lives
  const std::string what_;
  const bool terminal_;
  const Clock::time_point start_;
  std::mutex mutex_;  // of all below
  std::condition_variable ended_;
  std::size_t done_ = 0, total_;
  Clock::time_point step_, drawn_at_;  // step_: last change of `done_`
  bool drawn_ = false, end_ = false;
  std::thread between_;
};

// "12 s left", "4 min left", "1 h 20 min left", at the average speed so far. "" before 5 % or 2 s, and after
// the predicted end.
std::string time_left(double until_step_s, double since_step_s, std::size_t done, std::size_t total);

// Removes the bar before other text is printed.
void clear_progress();

}  // namespace ifog::tools

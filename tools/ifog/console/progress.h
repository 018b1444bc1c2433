// SPDX-License-Identifier: Apache-2.0
// A progress bar with the time left for anything that lasts over a second, on a terminal only; silent
// elsewhere.
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

  // Whether a thread of its own redraws between the steps, so that a long step shows that it lasts. Not
  // where a thread would be in the way.
  enum class Between { redraw, nothing };

  // total: of whatever is counted, steps or rows or bytes; 0: not known, then the time spent is shown.
  Progress(const std::string& what, std::size_t total, Between between = Between::redraw);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  // Cheap: looks at the clock and redraws at most ten times a second. A total that was not known before may
  // come with it.
  void at(std::size_t done) { at(done, total_); }
  void at(std::size_t done, std::size_t total);

  // For what tells its progress without knowing of this.
  [[nodiscard]] std::function<void(std::size_t done, std::size_t total)> teller();

 private:
  void draw(Clock::time_point now);
  void redraw_between() noexcept;

  Progress* const outer_;  // that this one stands before: one bar at a time
  const std::string what_;
  const bool terminal_;
  const Clock::time_point start_;
  std::mutex mutex_;  // of all below
  std::condition_variable ended_;
  std::size_t done_ = 0, total_;
  Clock::time_point step_, drawn_at_;  // when `done_` came
  bool drawn_ = false, end_ = false;
  std::thread between_;
};

// "12 s left", "4 min left", "1 h 20 min left": the rest takes as long as what was done took, less what has
// gone since then. "" before a twentieth is done, unless two seconds have gone, and when it should have
// ended.
std::string time_left(double until_step_s, double since_step_s, std::size_t done, std::size_t total);

// Before other text goes to the terminal: no bar stands in its line.
void clear_progress();

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/progress.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <system_error>

#include "drivers/ifog/quoted.h"

namespace ifog::tools {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kQuiet = 1s, kBetween = 250ms, kLeastPause = 100ms;

std::mutex line;           // of the terminal
bool bar_on_line = false;  // guarded by `line`
std::atomic<Progress*> innermost = nullptr;

double seconds(Progress::Clock::duration span) { return std::chrono::duration<double>(span).count(); }

}  // namespace

Progress::Progress(const std::string& what, std::size_t total, Between between)
    : outer_(innermost.exchange(this)),
      what_(printable(what)),  // may contain an axis name from the capture
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      total_(total),
      step_(start_),
      drawn_at_(start_) {
  if (!terminal_ || between != Between::redraw) return;
  try {
    between_ = std::thread([this] { redraw_between(); });
  } catch (const std::system_error&) {
    // Without a thread, only at() redraws.
  }
}

Progress::~Progress() {
  if (between_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      end_ = true;
    }
    ended_.notify_all();
    between_.join();
  }
  innermost = outer_;
  if (drawn_) clear_progress();
}

// If memory for drawing is exhausted, this thread must not end the program.
void Progress::redraw_between() noexcept try {
  std::unique_lock lock(mutex_);
  if (ended_.wait_for(lock, kQuiet, [this] { return end_; })) return;
  do draw(Clock::now());
  while (!ended_.wait_for(lock, kBetween, [this] { return end_; }));
} catch (const std::exception&) {
}

void Progress::at(std::size_t done, std::size_t total) {
  if (!terminal_) return;
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  if (done != done_) step_ = now;
  done_ = done;
  total_ = total;
  if (now - start_ >= kQuiet) draw(now);
}

void Progress::draw(Clock::time_point now) {
  if (innermost != this || (drawn_ && now - drawn_at_ < kLeastPause)) return;
  drawn_at_ = now;
  drawn_ = true;
  std::string text = what_;
  if (total_ > 0) {
    constexpr std::size_t kWidth = 30;
    const double share = std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_));
    const auto filled = static_cast<std::size_t>(share * static_cast<double>(kWidth));
    text += " [" + std::string(filled, '#') + std::string(kWidth - filled, '.') + "] " +
            std::to_string(static_cast<int>(100.0 * share)) + " %";
  }
  const std::string left = time_left(seconds(step_ - start_), seconds(now - step_), done_, total_);
  text +=
      ", " + (left.empty() ? std::to_string(static_cast<long>(seconds(now - start_))) + " s so far" : left);
  const std::lock_guard lock(line);
  bar_on_line = true;
  std::fprintf(stderr, "\r%s\x1b[K", text.c_str());
  std::fflush(stderr);
}

std::function<void(std::size_t, std::size_t)> Progress::teller() {
  return [this](std::size_t done, std::size_t total) { at(done, total); };
}

std::string time_left(double until_step_s, double since_step_s, std::size_t done, std::size_t total) {
  constexpr double kLeastShare = 0.05, kLeast_s = 2.0;
  if (done == 0 || done >= total) return "";
  const double share = static_cast<double>(done) / static_cast<double>(total);
  if (share < kLeastShare && until_step_s + since_step_s < kLeast_s) return "";
  // Without the rounded share, so that exact results stay exact.
  const double left_s =
      until_step_s * static_cast<double>(total - done) / static_cast<double>(done) - since_step_s;
  if (left_s <= 0.0) return "";
  const auto up_to = [&](double step) { return static_cast<long>(std::ceil(left_s / step)); };
  if (left_s <= 20.0) return std::to_string(up_to(1.0)) + " s left";
  if (left_s <= 90.0) return std::to_string(up_to(5.0) * 5) + " s left";
  const long minutes = up_to(60.0);
  if (minutes < 60) return std::to_string(minutes) + " min left";
  return std::to_string(minutes / 60) + " h" +
         (minutes % 60 == 0 ? "" : " " + std::to_string(minutes % 60) + " min") + " left";
}

void clear_progress() {
  const std::lock_guard lock(line);
  if (!bar_on_line) return;
  bar_on_line = false;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
}

}  // namespace ifog::tools

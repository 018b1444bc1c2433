// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <mutex>
#include <system_error>
#include <utility>

#include "drivers/ifog/quoted.h"

namespace ifog::tools {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kQuiet = 1s, kBetween = 250ms;

std::mutex line;           // of the terminal
bool bar_on_line = false;  // guarded by `line`
std::atomic<Progress*> innermost = nullptr;

double seconds(Progress::Clock::duration span) { return std::chrono::duration<double>(span).count(); }

}  // namespace

Progress::Progress(const std::string& what, std::size_t total)
    : outer_(innermost.exchange(this)),
      what_(printable(what)),  // may contain an axis name from the capture
      start_(Clock::now()),
      total_(total) {
  if (isatty(STDERR_FILENO) != 1) return;
  try {
    drawing_ = std::jthread([this](const std::stop_token& end) { redraw(end); });
  } catch (const std::system_error&) {
    // Without a thread nothing is drawn.
  }
}

Progress::~Progress() {
  drawing_ = {};
  innermost = outer_;
  clear_progress();
}

// If memory for drawing is exhausted, this thread must not end the program.
void Progress::redraw(const std::stop_token& end) noexcept try {
  std::mutex mutex;
  std::condition_variable_any ended;
  std::unique_lock lock(mutex);
  std::size_t before = 0;
  for (Clock::time_point step = start_;
       !ended.wait_for(lock, end, kBetween, [&] { return end.stop_requested(); });) {
    const Clock::time_point now = Clock::now();
    const std::size_t done = done_;
    if (std::exchange(before, done) != done) step = now;
    if (now - start_ >= kQuiet && innermost == this) draw(now, step, done);
  }
} catch (const std::exception&) {
}

// step: when `done` was reached.
void Progress::draw(Clock::time_point now, Clock::time_point step, std::size_t done) const {
  std::string text = what_;
  const std::size_t total = total_;
  if (total > 0) {
    constexpr std::size_t kWidth = 30;
    const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
    const auto filled = static_cast<std::size_t>(share * static_cast<double>(kWidth));
    text += fmt::format(" [{:.<{}}] {} %", std::string(filled, '#'), kWidth, static_cast<int>(100.0 * share));
  }
  const std::string left = time_left(seconds(step - start_), seconds(now - step), done, total);
  text += left.empty() ? fmt::format(", {:.0f} s so far", std::floor(seconds(now - start_))) : ", " + left;
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
  if (left_s <= 20.0) return fmt::format("{} s left", up_to(1.0));
  if (left_s <= 90.0) return fmt::format("{} s left", up_to(5.0) * 5);
  const long minutes = up_to(60.0);
  if (minutes < 60) return fmt::format("{} min left", minutes);
  if (minutes % 60 == 0) return fmt::format("{} h left", minutes / 60);
  return fmt::format("{} h {} min left", minutes / 60, minutes % 60);
}

void clear_progress() {
  const std::lock_guard lock(line);
  if (!bar_on_line) return;
  bar_on_line = false;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
}

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "drivers/ifog/quoted.h"

namespace ifog::tools {

Progress::Progress(const std::string& what, std::size_t total)
    : what_(printable(what)),  // an axis has its name from the capture
      total_(std::max<std::size_t>(total, 1)),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);
}

void Progress::at(std::size_t done) {
  if (!terminal_) return;
  using namespace std::chrono_literals;
  const auto now = std::chrono::steady_clock::now();
  if (now - start_ < 1s || now - last_ < 100ms) return;
  last_ = now;
  drawn_ = true;
  constexpr std::size_t kWidth = 40;
  const std::size_t filled = std::min(kWidth, done * kWidth / total_);
  std::string bar(filled, '#');
  bar.resize(kWidth, '.');
  std::fprintf(stderr, "\r%s [%s] %3zu %%", what_.c_str(), bar.c_str(),
               std::min<std::size_t>(100, done * 100 / total_));
  std::fflush(stderr);
}

}  // namespace ifog::tools

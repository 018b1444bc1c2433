// SPDX-License-Identifier: Apache-2.0
#include "daemon/realtime/thread_watch.h"

#include <unistd.h>

#include <charconv>
#include <fstream>
#include <iterator>
#include <string>

namespace ifog {
namespace {

constexpr int kUserTime = 14, kSystemTime = 15;  // fields, from 1; the state is the third

}  // namespace

// The name, in brackets, may contain anything, so fields are counted from the last bracket.
ThreadTime parse_thread_stat(std::string_view text) {
  ThreadTime out;
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string_view::npos) return out;
  text.remove_prefix(name_end + 1);
  for (int field = 3; field <= kSystemTime; ++field) {
    const std::size_t begin = text.find_first_not_of(' ');
    if (begin == std::string_view::npos) return {};
    text.remove_prefix(begin);
    const std::string_view word = text.substr(0, text.find(' '));
    if (field == 3) out.state = word.front();
    if (field == kUserTime || field == kSystemTime) {
      std::uint64_t ticks = 0;
      std::from_chars(word.data(), word.data() + word.size(), ticks);
      out.ticks += ticks;
    }
    text.remove_prefix(word.size());
  }
  return out;
}

bool starved_between(const ThreadTime& before, const ThreadTime& now) {
  return before.state == 'R' && now.state == 'R' && before.ticks == now.ticks;
}

void ThreadWatch::begin() noexcept { thread_.store(gettid(), std::memory_order_relaxed); }

bool ThreadWatch::starved() {
  std::ifstream file("/proc/self/task/" + std::to_string(thread_.load(std::memory_order_relaxed)) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const ThreadTime now = parse_thread_stat(text);
  const bool out = starved_between(before_, now);
  before_ = now;
  return out;
}

}  // namespace ifog

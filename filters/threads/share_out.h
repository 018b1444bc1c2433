// SPDX-License-Identifier: Apache-2.0
// Distributes work among threads, one item at a time.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace ifog {

// Calls work(i) for all i below `items`, in order of start. threads 0: number of processors. Rethrows one
// exception after all have ended.
template <typename Work>
void share_out(std::size_t items, unsigned threads, const Work& work) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex guard;
  const auto run = [&] {
    for (std::size_t i = next++; i < items; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(guard);
        failure = std::current_exception();
      }
    }
  };
  const auto wanted = std::min<std::size_t>(threads, items);
  std::vector<std::thread> others;
  others.reserve(wanted);
  for (std::size_t i = 1; i < wanted; ++i) {
    try {
      others.emplace_back(run);
    } catch (const std::system_error&) {
      break;  // no more threads: the existing ones do the work
    }
  }
  run();
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace ifog

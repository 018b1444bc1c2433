// SPDX-License-Identifier: Apache-2.0
// A system that has no thread left. This program's pthread_create stands before the system's.
#include <dlfcn.h>
#include <pthread.h>

#include "tests/unit/daemon/rig.h"
#include "tests/unit/test.h"

namespace {

std::atomic<int> threads_left{INT_MAX};

}  // namespace

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*),
                              void* argument) {
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  if (threads_left.fetch_sub(1) <= 0) return EAGAIN;
  return create(thread, attributes, run, argument);
}

namespace ifog {
namespace {

std::ptrdiff_t threads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return std::distance(begin(tasks), end(tasks));
}

// The kernel lists a thread that was joined for a moment longer.
std::ptrdiff_t threads_once_there_are(std::ptrdiff_t expected) {
  using namespace std::chrono_literals;
  const auto until = std::chrono::steady_clock::now() + 5s;
  while (threads() != expected && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(1ms);
  return threads();
}

// Neither the first thread, nor the second when the first already runs: start-up must not wait for it.
TEST(Threads, APipelineThatCannotHaveBothHasNone) {
  // With the first one a sanitizer makes one of its own.
  std::ptrdiff_t before = 0;
  std::thread([&] { before = threads() - 1; }).join();
  for (const int left : {0, 1}) {
    Rig rig({}, kFrame, true);
    threads_left = left;
    try {
      rig.pipeline->start();
      ADD_FAILURE() << "started with " << left;
    } catch (const std::system_error& error) {
      EXPECT_EQ(error.code().value(), EAGAIN);
    }
    EXPECT_LT(threads_left.load(), 0);  // it was this function that refused
    threads_left = INT_MAX;
    EXPECT_EQ(threads_once_there_are(before), before);
  }
}

}  // namespace
}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// A system that has no thread left. This program's pthread_create stands before the system's.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <thread>

#include "daemon/pipeline/pipeline.h"

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

class SilentTransport final : public Transport {
 public:
  SilentTransport() : Transport("silent") {}
  bool connect(std::string&, std::int64_t) override { return true; }
  Delivery receive(std::int64_t until_ns) noexcept override {
    short happened = 0;
    waiting_.wait(-1, 0, until_ns, happened);
    return {};
  }
};

class NoPublisher final : public Publisher {
 public:
  bool publish(const char*, std::span<const std::uint8_t>) noexcept override { return true; }
};

std::unique_ptr<Pipeline> pipeline() {
  DriverInstance driver = make_driver("kvh1750", {});
  PipelinePlan plan;
  plan.lcm_channel = "test";
  plan.facts = sensor_facts(driver.description(), 1000.0, 0);
  ChainSettings chain;
  chain.facts = plan.facts;
  chain.axes = {"x", "y", "z"};
  chain.channels.assign(driver.description().environments, "channel_V");
  chain.channel_max_age_s.assign(driver.description().environments, 10.0);
  auto made =
      std::make_unique<Pipeline>(plan, std::make_unique<SilentTransport>(), std::move(driver), nullptr,
                                 std::make_unique<ChainParts>(chain), std::make_unique<NoPublisher>());
  made->open();
  return made;
}

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
    const std::unique_ptr<Pipeline> one = pipeline();
    threads_left = left;
    try {
      one->start();
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

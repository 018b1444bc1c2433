// SPDX-License-Identifier: Apache-2.0
#include "daemon/realtime/realtime.h"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>

namespace ifog {
namespace {

constexpr std::size_t kStack = 64 * 1024;  // deeper than any path of the loops
constexpr std::size_t kLockedStack = 8 * kStack;
constexpr std::size_t kPage = 4096;

std::string reason(int error) { return std::strerror(error); }

}  // namespace

void prefault_stack() noexcept {
  std::array<volatile char, kStack> stack;
  for (std::size_t i = 0; i < kStack; i += kPage) stack[i] = 0;
}

std::string apply_to_this_thread(const ThreadPlan& plan) {
  std::string missed;
  const pthread_t self = pthread_self();
  // Of the 15 characters that the kernel keeps, the last ones tell a sensor's threads apart.
  const std::size_t end = std::min(plan.name.rfind(':'), plan.name.size());
  const std::string role = plan.name.substr(end);
  pthread_setname_np(self, (plan.name.substr(0, std::min(end, 15 - role.size())) + role).c_str());
  if (!plan.cpus.empty()) {
    cpu_set_t set;
    CPU_ZERO(&set);
    for (const int cpu : plan.cpus) CPU_SET(static_cast<std::size_t>(cpu), &set);
    if (const int error = pthread_setaffinity_np(self, sizeof set, &set))
      missed += plan.name + ": processors not set: " + reason(error) + "; ";
  }
  if (plan.priority > 0) {
    sched_param wanted{};
    wanted.sched_priority = plan.priority;
    if (const int error = pthread_setschedparam(self, SCHED_FIFO, &wanted))
      missed += plan.name + ": SCHED_FIFO priority " + std::to_string(plan.priority) +
                " refused: " + reason(error) + " (needs CAP_SYS_NICE or LimitRTPRIO); ";
  }
  if (!missed.empty()) missed.resize(missed.size() - 2);
  return missed;
}

std::string lock_memory() {
  // Locked stacks are fully resident, and the default 8 MiB would be 16 MiB per sensor. Later threads get
  // smaller stacks, many times what their loops need.
  pthread_attr_t attributes;
  if (pthread_getattr_default_np(&attributes) == 0) {
    pthread_attr_setstacksize(&attributes, kLockedStack);
    pthread_setattr_default_np(&attributes);
    pthread_attr_destroy(&attributes);
  }
  // malloc keeps its memory, because returning and refaulting pages would delay the loop.
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  // One heap for all threads: separate ones lock 64 MiB of address space each. The hot path does not
  // allocate.
  mallopt(M_ARENA_MAX, 1);
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return "";
  return "memory not locked: " + reason(errno) + " (needs CAP_IPC_LOCK or LimitMEMLOCK)";
}

void ThreadWatch::begin() noexcept { thread_.store(gettid(), std::memory_order_relaxed); }

// proc(5): the state is the third field, the times of user and system are 14 and 15. The name, in brackets, may
// contain anything, so fields are counted from the last bracket.
bool ThreadWatch::starved() {
  std::ifstream file("/proc/self/task/" + std::to_string(thread_.load(std::memory_order_relaxed)) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::istringstream fields(text.substr(text.rfind(')') + 1));
  char state = '?';
  std::string between;
  std::uint64_t user = 0, system = 0;
  fields >> state;
  for (int field = 4; field < 14; ++field) fields >> between;
  fields >> user >> system;
  const bool was_ready = std::exchange(state_, state) == 'R';
  const bool worked = std::exchange(ticks_, user + system) != user + system;
  return was_ready && state == 'R' && !worked;
}

}  // namespace ifog

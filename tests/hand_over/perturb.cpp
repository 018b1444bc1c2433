// SPDX-License-Identifier: Apache-2.0
// Disturbs the order of events between threads. It is preloaded into a program built with ThreadSanitizer and
// intercepts every atomic operation, futex, sleep and pthread call; sometimes it yields to another thread or
// waits for up to a tenth of a millisecond.
//
//   IFOG_PERTURB_SEED   selects the order; default 1
//
// At the end it prints the number of calls and of disturbances on standard error.
#include <dlfcn.h>
#include <linux/futex.h>
#include <pthread.h>
#include <sched.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace {

// Built without ThreadSanitizer: atomics here would call this library.
std::uint64_t calls, disturbed;

std::uint64_t seed() {
  const char* const text = getenv("IFOG_PERTURB_SEED");
  return text != nullptr ? strtoull(text, nullptr, 10) : 1;
}

// Marsaglia's xorshift, one per thread.
std::uint64_t draw() {
  static thread_local std::uint64_t state = 0;
  if (state == 0) state = seed() * 0x9E3779B97F4A7C15ULL ^ static_cast<std::uint64_t>(gettid()) << 20U ^ 1U;
  state ^= state << 13U;
  state ^= state >> 7U;
  state ^= state << 17U;
  return state;
}

template <typename Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

// By register, because syscall() is intercepted by this library.
long raw_syscall(long number, long a, long b) {
  long result = 0;
  asm volatile("syscall" : "=a"(result) : "a"(number), "D"(a), "S"(b) : "rcx", "r11", "memory");
  return result;
}

void disturb() {
  __atomic_fetch_add(&calls, 1, __ATOMIC_RELAXED);
  const std::uint64_t fate = draw() >> 20U;
  if (fate % 32 != 0) return;
  __atomic_fetch_add(&disturbed, 1, __ATOMIC_RELAXED);
  if (fate % 1024 != 0) {
    raw_syscall(SYS_sched_yield, 0, 0);
    return;
  }
  const timespec pause{0, static_cast<long>(1000 + (fate >> 10U) % 100'000)};
  raw_syscall(SYS_nanosleep, reinterpret_cast<long>(&pause), 0);
}

[[gnu::destructor]] void report() {
  fprintf(stderr, "perturbed: %llu calls, %llu disturbed\n", static_cast<unsigned long long>(calls),
          static_cast<unsigned long long>(disturbed));
}

}  // namespace

#define IFOG_BEFORE(result, name, parameters, arguments)                   \
  extern "C" result name parameters {                                      \
    static result(*function) parameters = nullptr;                         \
    if (function == nullptr) function = next<result(*) parameters>(#name); \
    disturb();                                                             \
    return function arguments;                                             \
  }

// The interface of ThreadSanitizer's runtime to compiled atomics (sanitizer/tsan_interface_atomic.h).
#define IFOG_ATOMIC(bits, type)                                                                             \
  IFOG_BEFORE(type, __tsan_atomic##bits##_load, (const volatile type* a, int order), (a, order))            \
  IFOG_BEFORE(void, __tsan_atomic##bits##_store, (volatile type * a, type v, int order), (a, v, order))     \
  IFOG_BEFORE(type, __tsan_atomic##bits##_exchange, (volatile type * a, type v, int order), (a, v, order))  \
  IFOG_BEFORE(type, __tsan_atomic##bits##_fetch_add, (volatile type * a, type v, int order), (a, v, order)) \
  IFOG_BEFORE(type, __tsan_atomic##bits##_fetch_sub, (volatile type * a, type v, int order), (a, v, order)) \
  IFOG_BEFORE(type, __tsan_atomic##bits##_fetch_and, (volatile type * a, type v, int order), (a, v, order)) \
  IFOG_BEFORE(type, __tsan_atomic##bits##_fetch_or, (volatile type * a, type v, int order), (a, v, order))  \
  IFOG_BEFORE(int, __tsan_atomic##bits##_compare_exchange_strong,                                           \
              (volatile type * a, type * expected, type v, int order, int failed),                          \
              (a, expected, v, order, failed))                                                              \
  IFOG_BEFORE(int, __tsan_atomic##bits##_compare_exchange_weak,                                             \
              (volatile type * a, type * expected, type v, int order, int failed),                          \
              (a, expected, v, order, failed))

IFOG_ATOMIC(8, char)
IFOG_ATOMIC(16, short)
IFOG_ATOMIC(32, int)
IFOG_ATOMIC(64, long)

IFOG_BEFORE(int, pthread_mutex_lock, (pthread_mutex_t * mutex), (mutex))
IFOG_BEFORE(int, pthread_mutex_unlock, (pthread_mutex_t * mutex), (mutex))
IFOG_BEFORE(int, pthread_cond_signal, (pthread_cond_t * condition), (condition))
IFOG_BEFORE(int, pthread_cond_broadcast, (pthread_cond_t * condition), (condition))
IFOG_BEFORE(int, nanosleep, (const timespec* span, timespec* left), (span, left))
IFOG_BEFORE(int, clock_nanosleep, (clockid_t clock, int flags, const timespec* span, timespec* left),
            (clock, flags, span, left))

// Intercepts the futex system call by its number, before sleeping and before waking.
extern "C" long syscall(long number, ...) {
  static long (*function)(long, ...) = nullptr;
  if (function == nullptr) function = next<long (*)(long, ...)>("syscall");
  va_list list;
  va_start(list, number);
  long a[6];
  for (long& argument : a) argument = va_arg(list, long);
  va_end(list);
  if (number == SYS_futex) disturb();
  return function(number, a[0], a[1], a[2], a[3], a[4], a[5]);
}

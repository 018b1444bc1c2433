// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/malloc_counter.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <string>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define IFOG_SANITIZED 1
#else
#define IFOG_SANITIZED 0
#endif

namespace {
std::atomic<bool> counting{false};
std::atomic<std::uint64_t> allocations{0};
void count() {
  if (counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace

#if !IFOG_SANITIZED
// glibc's own, under the names it exports for this purpose.
extern "C" {
void* __libc_malloc(std::size_t);                 // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t, std::size_t);    // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void*, std::size_t);         // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t, std::size_t);  // NOLINT(bugprone-reserved-identifier)

void* malloc(std::size_t size) {
  count();
  return __libc_malloc(size);
}
void* calloc(std::size_t n, std::size_t size) {
  count();
  return __libc_calloc(n, size);
}
void* realloc(void* old, std::size_t size) {
  count();
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  count();
  *out = __libc_memalign(alignment, size);
  return *out == nullptr ? ENOMEM : 0;
}
}
#endif

namespace ifog::test {

bool allocations_can_be_counted() { return IFOG_SANITIZED == 0; }
void count_allocations(bool on) { counting = on; }
std::uint64_t take_allocations() { return allocations.exchange(0); }

bool allocation_counter_works() {
  allocations = 0;
  counting = true;
  std::free(std::malloc(100));  // NOLINT(cppcoreguidelines-no-malloc)
  delete new std::string(100, 'x');
  counting = false;
  return take_allocations() >= 2;
}

}  // namespace ifog::test

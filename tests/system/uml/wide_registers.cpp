// SPDX-License-Identifier: Apache-2.0
// Lets Debian's user-mode Linux run on processors with AMX. That kernel stores floating-point registers in a
// buffer of fixed size, shorter than the state of such a processor, and the host's kernel rejects a partial
// write (EFAULT, xstateregs_set). This preloaded shim copies the short state over the whole one before
// writing.
#include <dlfcn.h>
#include <elf.h>
#include <sys/ptrace.h>
#include <sys/uio.h>

#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstring>

namespace {

constexpr std::size_t kLongest = 1 << 16;
constexpr std::size_t kHeaderAt = 512;  // XSTATE_BV, Intel SDM vol. 1, 13.4.2
// State components in the short buffer (2696 bytes): all except the tiles.
constexpr std::uint64_t kKept = 0x2ff;

using Ptrace = long (*)(int, long, void*, void*);

}  // namespace

extern "C" long ptrace(enum __ptrace_request request, ...) noexcept {
  static const auto real = reinterpret_cast<Ptrace>(dlsym(RTLD_NEXT, "ptrace"));
  va_list arguments;
  va_start(arguments, request);
  const long process = va_arg(arguments, int);
  void* address = va_arg(arguments, void*);
  void* data = va_arg(arguments, void*);
  va_end(arguments);

  const long result = real(request, process, address, data);
  if (result == 0 || request != PTRACE_SETREGSET || errno != EFAULT ||
      reinterpret_cast<std::uintptr_t>(address) != NT_X86_XSTATE)
    return result;

  alignas(64) static unsigned char whole[kLongest];
  iovec all{whole, sizeof whole};
  if (real(PTRACE_GETREGSET, process, address, &all) != 0) return -1;
  const auto* given = static_cast<const iovec*>(data);
  if (given->iov_len > all.iov_len) {
    errno = EFAULT;
    return -1;
  }
  std::uint64_t present = 0;
  std::memcpy(whole, given->iov_base, given->iov_len);
  std::memcpy(&present, whole + kHeaderAt, sizeof present);
  present &= kKept;
  std::memcpy(whole + kHeaderAt, &present, sizeof present);
  return real(request, process, address, &all);
}

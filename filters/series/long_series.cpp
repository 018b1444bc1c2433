// SPDX-License-Identifier: Apache-2.0
#include "filters/series/long_series.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace ifog {
namespace {

constexpr std::size_t kAtOnce = std::size_t{1} << 16U;  // numbers written together

std::string folder() {
  const char* const named = std::getenv("TMPDIR");
  if (named != nullptr && *named != '\0') return named;
  // What is in /tmp may be memory again.
  return ::access("/var/tmp", W_OK | X_OK) == 0 ? "/var/tmp" : "/tmp";
}

[[noreturn]] void fail(const char* what) {
  const std::string reason = std::generic_category().message(errno);
  throw std::runtime_error(folder() + ": " + what + " a file for what is longer than memory is for: " +
                           reason + "; expected room there, or TMPDIR with the name of another folder");
}

int opened() {
  const std::string where = folder();
  const int fd = ::open(where.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (fd >= 0) return fd;
  std::string name = where + "/ifog-XXXXXX";
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named < 0) fail("cannot make");
  ::unlink(name.c_str());
  return named;
}

}  // namespace

LongSeries::~LongSeries() {
  if (fd_ >= 0) ::close(fd_);
}

LongSeries::LongSeries(LongSeries&& other) noexcept
    : most_(other.most_),
      recent_(std::exchange(other.recent_, {})),
      filed_(std::exchange(other.filed_, 0)),
      fd_(std::exchange(other.fd_, -1)) {}

LongSeries& LongSeries::operator=(LongSeries&& other) noexcept {
  std::swap(most_, other.most_);
  std::swap(recent_, other.recent_);
  std::swap(filed_, other.filed_);
  std::swap(fd_, other.fd_);
  return *this;
}

void LongSeries::add(double value) {
  recent_.push_back(value);
  if (recent_.size() >= (fd_ < 0 ? most_ + 1 : kAtOnce)) file_recent();
}

void LongSeries::add(std::span<const double> values) {
  recent_.insert(recent_.end(), values.begin(), values.end());
  if (recent_.size() >= (fd_ < 0 ? most_ + 1 : kAtOnce)) file_recent();
}

void LongSeries::file_recent() {
  const bool first = fd_ < 0;
  if (first) fd_ = opened();
  const char* at = reinterpret_cast<const char*>(recent_.data());
  std::size_t left = recent_.size() * sizeof(double), offset = filed_ * sizeof(double);
  while (left > 0) {
    const ssize_t n = ::pwrite(fd_, at, left, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("cannot write");
    at += n;
    left -= static_cast<std::size_t>(n);
    offset += static_cast<std::size_t>(n);
  }
  filed_ += recent_.size();
  if (first)
    recent_ = {};  // what was held in memory is given back
  else
    recent_.clear();
  recent_.reserve(kAtOnce);
}

void LongSeries::read(std::size_t first, std::span<double> to) const {
  const std::size_t filed = first < filed_ ? std::min(filed_ - first, to.size()) : 0;
  char* at = reinterpret_cast<char*>(to.data());
  std::size_t left = filed * sizeof(double), offset = first * sizeof(double);
  while (left > 0) {
    const ssize_t n = ::pread(fd_, at, left, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) errno = EIO;
    if (n <= 0) fail("cannot read");
    at += n;
    left -= static_cast<std::size_t>(n);
    offset += static_cast<std::size_t>(n);
  }
  if (filed < to.size())
    std::copy_n(recent_.begin() + static_cast<std::ptrdiff_t>(first + filed - filed_), to.size() - filed,
                to.begin() + static_cast<std::ptrdiff_t>(filed));
}

}  // namespace ifog

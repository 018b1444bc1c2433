// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/files/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

std::string reason() { return std::generic_category().message(errno); }

int opened(const std::string& path, int flags = 0) {
  if (path != "-") return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | flags);
  // Standard input can only be read once.
  static std::atomic_flag in_use = ATOMIC_FLAG_INIT;
  if (in_use.test_and_set())
    throw std::runtime_error("-: standard input is read already, expected it once among the inputs");
  return fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
}

constexpr std::string_view kRecording = ".ifr", kOpenEnding = ".open";

// Flight recordings of a folder by name, the open one last.
std::deque<std::string> recordings_among(const std::string& folder, std::error_code& error) {
  std::deque<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    std::string_view name = entry.path().native();
    if (name.ends_with(kOpenEnding)) name.remove_suffix(kOpenEnding.size());
    if (name.ends_with(kRecording)) out.push_back(entry.path().string());
  }
  std::ranges::sort(out);
  return out;
}

// Name of one sensor's folder in a folder of several sensors' recordings, or "".
std::string such_as(const std::string& folder) {
  std::vector<std::string> of_a_sensor;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (std::error_code unread; entry.is_directory(unread) && !recordings_among(entry.path(), unread).empty())
      of_a_sensor.push_back(entry.path().string());
  const auto first = std::ranges::min_element(of_a_sensor);
  return first == of_a_sensor.end() ? "" : ", as " + *first;
}

std::deque<std::string> recordings_in(const std::string& folder) {
  std::error_code error;
  std::deque<std::string> out = recordings_among(folder, error);
  if (error) throw std::runtime_error(folder + ": cannot read: " + error.message());
  if (out.empty())
    throw std::runtime_error(
        folder + ": is a folder, expected a file, or the folder of one sensor's flight recordings (.ifr)" +
        such_as(folder));
  return out;
}

// Limit of a gzip file's content in multiples of its size, except for rows of numbers.
constexpr std::size_t kMostGrowth = 100;
constexpr std::size_t kGrowthFree = 256U << 20U;

}  // namespace

void refuse_long_line(const std::string& path, std::size_t number, std::string_view line) {
  throw std::runtime_error(path + ":" + std::to_string(number) + ": a line of more than " +
                           std::to_string(kLongestLine) + " bytes, begins " +
                           in_quotes(line.substr(0, kLongestQuote)));
}

void InputFile::Close::operator()(gzFile_s* file) const { gzclose(file); }

InputFile::InputFile(std::string path) : path_(std::move(path)) {
  const int fd = opened(path_);
  if (fd < 0) throw std::runtime_error(path_ + ": cannot open: " + reason());
  struct stat info {};
  if (fstat(fd, &info) == 0 && S_ISDIR(info.st_mode)) {
    ::close(fd);
    more_ = recordings_in(path_);
    begin();
    return;
  }
  unpack_from(fd, path_);
  gzbuffer(file_.get(), 1U << 18U);
  if (S_ISREG(info.st_mode)) total_ = static_cast<std::size_t>(info.st_size);
  if (S_ISREG(info.st_mode) && gzdirect(file_.get()) == 0)
    most_ = std::max(kGrowthFree, static_cast<std::size_t>(info.st_size) * kMostGrowth);
  held_.resize(kHead);
  held_.resize(unpack(held_.data(), kHead));
  reopens_ = path_ != "-" && S_ISREG(info.st_mode) && gzdirect(file_.get()) == 1;
}

InputFile::InputFile(std::string path, std::deque<std::string> files)
    : path_(std::move(path)), more_(std::move(files)) {
  begin();
}

void InputFile::unpack_from(int fd, const std::string& path) {
  file_.reset(gzdopen(fd, "rb"));
  if (file_) return;
  ::close(fd);
  throw std::runtime_error(path + ": cannot open: " + reason());
}

void InputFile::begin() {
  std::error_code unknown;
  for (const std::string& file : more_)
    if (const auto bytes = std::filesystem::file_size(file, unknown); !unknown) total_ += bytes;
  open_next();
  held_.resize(kHead);
  held_.resize(unpack(held_.data(), kHead));
}

InputFile::InputFile(std::string path, std::string text) : path_(std::move(path)), held_(std::move(text)) {}

// Opens the folder's next file; false: none.
bool InputFile::open_next() {
  if (more_.empty()) return false;
  const std::string path = std::move(more_.front());
  more_.pop_front();
  // Others may write into a recorder's folder: neither links nor files with several names are read.
  int fd = opened(path, O_NOFOLLOW | O_NONBLOCK);
  // It may have been closed and renamed meanwhile.
  if (fd < 0 && errno == ENOENT && path.ends_with(kOpenEnding))
    fd = opened(path.substr(0, path.size() - kOpenEnding.size()), O_NOFOLLOW | O_NONBLOCK);
  if (fd < 0) throw std::runtime_error(path + ": cannot open: " + reason());
  struct stat info {};
  if (fstat(fd, &info) != 0 || !S_ISREG(info.st_mode) || info.st_nlink != 1) {
    ::close(fd);
    throw std::runtime_error(path + ": is no recording of this folder alone, expected a file with one name");
  }
  if (file_) behind_ += static_cast<std::size_t>(std::max<z_off_t>(0, gzoffset(file_.get())));
  unpack_from(fd, path);
  return true;
}

std::size_t InputFile::unpack(char* to, std::size_t most) {
  std::size_t done = 0;
  while (file_ && done < most) {
    const auto wanted = static_cast<unsigned>(std::min<std::size_t>(most - done, 1U << 30U));
    const int n = gzread(file_.get(), to + done, wanted);
    if (n > 0) done += static_cast<std::size_t>(n);
    if (report_ && total_ > 0)
      report_(behind_ + static_cast<std::size_t>(std::max<z_off_t>(0, gzoffset(file_.get()))), total_);
    if (n > 0 && most_ > 0 && (unpacked_ += static_cast<std::size_t>(n)) > most_ + rows_)
      throw std::runtime_error(path_ + ": grows to more than " + std::to_string(most_ >> 20U) + " MiB, " +
                               std::to_string(kMostGrowth) +
                               " times its size, when unpacked, expected a recording");
    if (n == static_cast<int>(wanted)) continue;
    // gzread also returns short at a truncated stream, and reports this only through gzerror.
    int error = Z_OK;
    const char* message = gzerror(file_.get(), &error);
    ends_early_ = error == Z_BUF_ERROR;
    if (ends_early_) break;
    if (error != Z_OK && error != Z_STREAM_END)
      throw std::runtime_error(path_ +
                               ": cannot read: " + (error == Z_ERRNO ? reason() : std::string(message)));
    if (!open_next()) break;
  }
  return done;
}

std::size_t InputFile::read(char* to, std::size_t most) {
  const std::size_t n = read_what_is_there(to, most);
  if (ends_early_)
    throw std::runtime_error(path_ + ": cannot read: the gzip stream ends early (truncated file)");
  return n;
}

std::size_t InputFile::read_what_is_there(char* to, std::size_t most) {
  const std::size_t ready = std::min(most, held_.size() - taken_);
  std::memcpy(to, held_.data() + taken_, ready);
  taken_ += ready;
  const std::size_t n = ready + unpack(to + ready, most - ready);
  if (observer_) observer_({to, n});
  return n;
}

std::string InputFile::bytes() {
  constexpr std::size_t kBlock = 1U << 20U;
  std::string all;
  for (std::size_t n = kBlock; n == kBlock;) {
    const std::size_t before = all.size();
    all.resize(before + kBlock);
    n = read(all.data() + before, kBlock);
    all.resize(before + n);
  }
  return all;
}

void InputFile::read_to_the_end() {
  std::vector<char> block(1U << 18U);
  while (read(block.data(), block.size()) > 0) {
  }
}

// Of the last whole line; npos if there is none. In a quoted cell, which may hold line ends, the quotes are odd.
static std::size_t last_line_end(std::string_view text) {
  const std::size_t last = text.rfind('\n');
  auto quotes = std::ranges::count(text.substr(0, last), '"');
  for (std::size_t at = last; at < text.size() && last - at < kLongestQuoted; quotes -= text[at--] == '"')
    if (text[at] == '\n' && quotes % 2 == 0) return at;
  return last;
}

TextPieces::TextPieces(ReadBytes read, std::size_t piece)
    : read_(std::move(read)), piece_(std::max<std::size_t>(1, piece)) {}

bool TextPieces::next(std::string& to) {
  // Reuses the string without zeroing it.
  std::size_t before = tail_.size();
  to.reserve(before + piece_ + piece_ / 16);
  if (to.size() < before) to.resize(before);
  std::copy(tail_.begin(), tail_.end(), to.begin());
  tail_.clear();
  while (!ended_) {
    to.resize(before + piece_);
    const std::size_t n = read_(to.data() + before, piece_);
    to.resize(before + n);
    ended_ = n < piece_;
    const std::size_t last = last_line_end(to);
    if (last == std::string::npos || last < before) {
      if (to.size() > kLongestLine) return true;
      before = to.size();
      continue;
    }
    tail_.assign(to, last + 1);
    to.resize(last + 1);
    return true;
  }
  to.resize(before);
  return !to.empty();
}

}  // namespace ifog

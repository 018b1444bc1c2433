// SPDX-License-Identifier: Apache-2.0
// Input file that is read once from its start; gzip is detected by its first bytes. It is never reopened or
// rewound, so standard input, a FIFO and a shell's <(command) are possible. A folder of flight recordings is
// read as one file.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

struct gzFile_s;  // zlib's

namespace ifog {

// Longer lines are not text.
inline constexpr std::size_t kLongestLine = 1U << 20U, kLongestQuoted = 4096;
// Rejects a longer line. Throws std::runtime_error.
[[noreturn]] void refuse_long_line(const std::string& path, std::size_t number, std::string_view line);

class InputFile {
 public:
  // "-" is standard input, once per process. Throws std::runtime_error with one line: missing, unreadable, a
  // folder without flight recordings.
  explicit InputFile(std::string path);
  // Reads these files in sequence; `path` names them in messages. Throws as above.
  InputFile(std::string path, std::deque<std::string> files);
  // A text in memory; `path` names it in messages.
  InputFile(std::string path, std::string text);

  [[nodiscard]] const std::string& path() const { return path_; }

  // First bytes, unpacked: kHead, or fewer if the file is shorter. Valid until the first read.
  static constexpr std::size_t kHead = 4096;
  [[nodiscard]] std::string_view head() const { return std::string_view(held_).substr(taken_, kHead); }

  // Reads up to `most` bytes, fewer only at the end, 0 there. Throws std::runtime_error with one line:
  // truncated or damaged gzip stream; a packed file that exceeds 256 MiB and 100 times its size, unless
  // were_rows() is called; I/O error.
  std::size_t read(char* to, std::size_t most);
  // The same, but reads a truncated gzip stream as far as possible; then ends_early() is true.
  std::size_t read_what_is_there(char* to, std::size_t most);
  [[nodiscard]] bool ends_early() const { return ends_early_; }
  // Excludes bytes that were rows of numbers from that limit: their text is not kept, and constant columns
  // pack well.
  void were_rows(std::size_t bytes) { rows_ += bytes; }
  // Reads to the end for the observer, after a library has read the file by its name.
  void read_to_the_end();
  // The rest of the file.
  std::string bytes();

  // From now on calls `report` with the number of bytes read from disk and the total; 0 if unknown.
  using Report = std::function<void(std::size_t done, std::size_t total)>;
  void report_to(Report report) { report_ = std::move(report); }
  // For readers that do not use read().
  void report(std::size_t done, std::size_t total) const {
    if (report_) report_(done, total);
  }

  // From now on calls `observer` with all bytes that read() and bytes() return.
  using Observer = std::function<void(std::string_view bytes)>;
  void observe(Observer observer) { observer_ = std::move(observer); }

  // True if path() can be opened again for the same bytes: a regular file that is not packed. For libraries
  // that open files by name.
  [[nodiscard]] bool reopens() const { return reopens_; }

 private:
  struct Close {
    void operator()(gzFile_s* file) const;
  };
  std::size_t unpack(char* to, std::size_t most);
  void unpack_from(int fd, const std::string& path);
  bool open_next();
  void begin();

  std::string path_;
  std::unique_ptr<gzFile_s, Close> file_;
  std::deque<std::string> more_;  // further files of a folder
  std::string held_;              // buffered: the head, or a given text
  std::size_t taken_ = 0;
  bool reopens_ = false, ends_early_ = false;
  Report report_;
  Observer observer_;
  std::size_t total_ = 0, behind_ = 0;              // bytes of all files, and of those read completely
  std::size_t unpacked_ = 0, rows_ = 0, most_ = 0;  // most_ 0: no limit
};

// Content of a file; "-" is standard input.
inline std::string read_whole_file(const std::string& path) { return InputFile(path).bytes(); }

// Reads up to `most` bytes, fewer only at the end, 0 there, as InputFile::read.
using ReadBytes = std::function<std::size_t(char* to, std::size_t most)>;

inline constexpr std::size_t kTextPiece = std::size_t{4} << 20U;  // in bytes; some ten thousand rows

// Splits a text of any length into pieces of whole lines.
class TextPieces {
 public:
  // piece: approximate size in bytes.
  explicit TextPieces(ReadBytes read, std::size_t piece = kTextPiece);

  // Replaces `to` by the next whole lines. False at the end. Only the last line may be incomplete, and it may
  // be too long.
  bool next(std::string& to);

 private:
  ReadBytes read_;
  std::size_t piece_;
  std::string tail_;
  bool ended_ = false;
};

}  // namespace ifog

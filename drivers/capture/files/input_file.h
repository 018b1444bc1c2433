// SPDX-License-Identifier: Apache-2.0
// A file read once, from its start, plain or gzip by its first bytes, whatever its name. Nothing is opened
// twice and nothing rewound, so that standard input, a FIFO and a shell's <(command) do as well as a file. A
// folder of flight recordings is read as one file: theirs, one behind the other.
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

// No line of a text that people or instruments write comes near it.
inline constexpr std::size_t kLongestLine = 1U << 20U;
// The one refusal of a longer line. Throws std::runtime_error.
[[noreturn]] void refuse_long_line(const std::string& path, std::size_t number, std::string_view line);

class InputFile {
 public:
  // "-" is standard input, once in a process. Throws std::runtime_error with one line: missing, unreadable, a
  // folder without flight recordings.
  explicit InputFile(std::string path);
  // These files, one behind the other; `path` stands for them. Throws as above.
  InputFile(std::string path, std::deque<std::string> files);
  // A text already at hand; `path` stands for the file.
  InputFile(std::string path, std::string text);

  [[nodiscard]] const std::string& path() const { return path_; }

  // The first bytes of what will be read, unpacked: kHead of them, fewer where the file is shorter. Valid
  // until the first read.
  static constexpr std::size_t kHead = 4096;
  [[nodiscard]] std::string_view head() const { return std::string_view(held_).substr(taken_, kHead); }

  // Up to `most` further bytes, fewer only at the end, 0 there. Throws std::runtime_error with one line: a
  // gzip stream that ends early or is damaged, a packed file that grows beyond 256 MiB and 100 times its
  // size without were_rows(), which no recording does and which would fill the memory; a device's error.
  std::size_t read(char* to, std::size_t most);
  // The same, but a gzip stream that ends early is read as far as it goes, and ends_early() says so behind it.
  std::size_t read_what_is_there(char* to, std::size_t most);
  [[nodiscard]] bool ends_early() const { return ends_early_; }
  // So many of the bytes read were rows of numbers, whose text is not kept. They do not count towards that limit,
  // because constant columns pack into a thousandth.
  void were_rows(std::size_t bytes) { rows_ += bytes; }
  // Reads to the end for the listener of hear(), after a library has read the file by its name.
  void read_to_the_end();
  // All of the rest.
  std::string bytes();

  // From here on `report` is called with the bytes of the file on the disk that have been read, and their total; 0 if
  // the total is unknown.
  using Report = std::function<void(std::size_t done, std::size_t total)>;
  void report_to(Report report) { report_ = std::move(report); }
  // For a reader that does not use read().
  void report(std::size_t done, std::size_t total) const {
    if (report_) report_(done, total);
  }

  // From here on `heard` is called with all bytes that read() and bytes() return.
  using Heard = std::function<void(std::string_view bytes)>;
  void hear(Heard heard) { heard_ = std::move(heard); }

  // Whether path() can be opened again for the same bytes: a regular file that is not packed. For libraries that
  // open files by name.
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
  std::deque<std::string> more_;  // the folder's other files
  std::string held_;              // at hand: the head, or all of a given text
  std::size_t taken_ = 0;
  bool reopens_ = false, ends_early_ = false;
  Report report_;
  Heard heard_;
  std::size_t total_ = 0, behind_ = 0;  // bytes of all files, and of those that were read to their end
  std::size_t unpacked_ = 0, rows_ = 0, most_ = 0;  // most_ 0: as much as comes
};

// All of a file's content; "-" is standard input.
inline std::string read_whole_file(const std::string& path) { return InputFile(path).bytes(); }

// Up to `most` further bytes, fewer only at the end, 0 there, as InputFile::read.
using ReadBytes = std::function<std::size_t(char* to, std::size_t most)>;

inline constexpr std::size_t kTextPiece = std::size_t{4} << 20U;  // bytes, some ten thousand rows

// A text of any length in pieces of whole lines.
class TextPieces {
 public:
  // piece: bytes, about so many at once.
  explicit TextPieces(ReadBytes read, std::size_t piece = kTextPiece);

  // Replaces `to` by the next whole lines. False at the end. Only the last line may have no end, and one longer
  // than any may be, to be refused.
  bool next(std::string& to);

 private:
  ReadBytes read_;
  std::size_t piece_;
  std::string tail_;
  bool ended_ = false;
};

}  // namespace ifog

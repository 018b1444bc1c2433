// SPDX-License-Identifier: Apache-2.0
// All output is written by this class. A regular file is never visible half-written: the bytes go into an unnamed
// file, which is synced and gets the name at the end. Links are followed; devices, FIFOs and open descriptors
// (/dev/stdout) are written directly and never replaced. What is called .gz is packed on its way.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

struct gzFile_s;  // zlib's

namespace ifog {

class OutputFile {
 public:
  // "-" is standard output. An existing file keeps its mode and, where that is allowed, its owner. Throws
  // std::runtime_error with one line: no such folder, a folder, no permission.
  explicit OutputFile(std::string path);
  // One that is open already, and from here on this object's to close; `path` stands for it in messages.
  OutputFile(std::string path, int descriptor);
  // Without finish() a regular file is unchanged and no temporary file remains.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Both throw std::runtime_error with one line: disk full, pipe closed, … SIGPIPE is the program's to
  // ignore. The bytes of a packed file are the same however they are cut.
  void write(std::string_view bytes);
  void finish();

  // What is written to it is not packed, whatever the file is called.
  [[nodiscard]] int descriptor() const { return fd_; }

 private:
  [[noreturn]] void fail(const char* what) const;
  void open();
  void open_beside();
  void take_the_name();

  std::string path_;    // as given, for messages
  std::string target_;  // the regular file; empty: written in place
  std::string beside_;  // the name of the bytes until finish(), where a file without one cannot be had
  int fd_ = -1;
  gzFile_s* packed_ = nullptr;  // null: the bytes go out as they are
};

// Identifies the regular file that a path leads to through links and open descriptors ("-" is standard output), or
// that it would create. Two names of one file have the same identity.
struct FileIdentity {
  std::uintmax_t device = 0, inode = 0;
  std::string name;  // of a file that is not there yet: in the folder that device and inode are of

  bool operator==(const FileIdentity&) const = default;
};

// nullopt for a device, a pipe, a folder and a path that leads nowhere, which cannot be overwritten by mistake.
[[nodiscard]] std::optional<FileIdentity> file_identity(const std::string& path);

// "-", /dev/stdout, /dev/fd/1 and whatever else leads to descriptor 1.
[[nodiscard]] bool is_standard_output(const std::string& path);

// Throws as OutputFile would, and leaves nothing behind: so that what cannot be written is known before the
// work. Of a device and a pipe nothing is asked.
void expect_writable(const std::string& path);

// All of it at once: nothing is touched if it fails.
void write_file(const std::string& path, std::string_view bytes);

}  // namespace ifog

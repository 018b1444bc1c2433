// SPDX-License-Identifier: Apache-2.0
// Output file, used for all output. A regular file is never visible incomplete: an unnamed file is written,
// synced and named at the end. Links are followed; devices, FIFOs and open descriptors (/dev/stdout) are
// written directly and never replaced. A name with .gz is packed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

struct gzFile_s;  // zlib's

namespace ifog {

class OutputFile {
 public:
  // "-" is standard output. An existing file keeps its mode and, if allowed, its owner. Throws
  // std::runtime_error with one line: missing folder, a folder, no permission.
  explicit OutputFile(std::string path);
  // An open descriptor, which this object will close; `path` names it in messages.
  OutputFile(std::string path, int descriptor);
  // Without finish() a regular file is not changed and no temporary file remains.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // These throw std::runtime_error with one line: disk full, pipe closed, … The program must ignore SIGPIPE.
  // A packed file does not depend on the sizes of writes.
  void write(std::string_view bytes);
  void finish();

  // Writing to the descriptor bypasses packing.
  [[nodiscard]] int descriptor() const { return fd_; }

 private:
  [[noreturn]] void fail(const char* what) const;
  void open();
  void open_temporary();
  void take_the_name();

  std::string path_;       // as given, for messages
  std::string target_;     // regular file; empty: written in place
  std::string temporary_;  // temporary name until finish(), if unnamed files are not supported
  int fd_ = -1;
  gzFile_s* packed_ = nullptr;  // null: not packed
};

// Identity of the regular file behind a path, links and open descriptors ("-" is standard output), or of the
// file that would be created.
struct FileIdentity {
  std::uintmax_t device = 0, inode = 0;
  std::string name;  // of a file that does not exist yet, in the folder given by device and inode

  bool operator==(const FileIdentity&) const = default;
};

// nullopt for a device, pipe, folder or invalid path, which cannot be overwritten accidentally.
[[nodiscard]] std::optional<FileIdentity> file_identity(const std::string& path);

// True for "-", /dev/stdout, /dev/fd/1 and others that lead to descriptor 1.
[[nodiscard]] bool is_standard_output(const std::string& path);

// Throws as OutputFile would, without creating anything, so that errors are found before the work. Devices
// and pipes are not checked.
void expect_writable(const std::string& path);

// Writes a whole file; unchanged on failure.
void write_file(const std::string& path, std::string_view bytes);

}  // namespace ifog

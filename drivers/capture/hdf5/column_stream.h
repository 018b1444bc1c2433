// SPDX-License-Identifier: Apache-2.0
// What stands behind the barrier says by a pipe what it has read: one header, then blocks of rows of every
// column in turn, or a refusal. Whoever writes it may have been taken over by
// the file that it reads, so every length is held to a limit and every number to what was said before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/hdf5/hdf5_columns.h"

namespace ifog {

// Throws std::runtime_error when the other end has gone.
using SendBytes = std::function<void(std::string_view)>;

void send_header(const SendBytes& send, const Hdf5Header& header);
void send_values(const SendBytes& send, std::span<const double> values);
void send_refusal(const SendBytes& send, std::string_view why);

class ColumnStream {
 public:
  // Fills the span, or returns false where the bytes end before.
  using ReceiveBytes = std::function<bool(std::span<char>)>;
  // Reads the header. Throws std::runtime_error with the refusal received, or std::length_error if the bytes
  // are no such stream.
  explicit ColumnStream(ReceiveBytes receive);

  [[nodiscard]] const Hdf5Header& header() const { return header_; }
  // The next rows of every column; false when all have come. Throws likewise.
  bool next(std::vector<std::vector<double>>& block);

 private:
  enum class Kind : unsigned char { header = 1, values = 2, refusal = 3 };
  struct Message {
    Kind kind;
    std::size_t bytes;
  };
  Message begin();
  // At most so many.
  void values(std::uint64_t most, std::vector<double>& to);
  [[noreturn]] void refused(std::size_t bytes);
  std::string text(std::size_t most);
  std::vector<std::string> texts(std::size_t most, std::size_t longest);
  std::uint64_t number();
  void take(std::span<char> to);

  ReceiveBytes receive_;
  Hdf5Header header_;
  std::uint64_t left_ = 0;      // rows that are to come
  std::size_t text_bytes_ = 0;  // taken so far

  friend void send_header(const SendBytes&, const Hdf5Header&);
  friend void send_values(const SendBytes&, std::span<const double>);
  friend void send_refusal(const SendBytes&, std::string_view);
};

}  // namespace ifog

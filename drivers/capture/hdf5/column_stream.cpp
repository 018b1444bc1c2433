// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/hdf5/column_stream.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace ifog {
namespace {

constexpr std::size_t kMostRefusal = 4096;                       // bytes
constexpr std::size_t kMostValues = 2U << 20U;                   // of a message
constexpr std::size_t kMostText = 64U << 20U;                    // bytes of a header
constexpr std::size_t kMostNotices = 16, kLongestNotice = 4096;  // lines, bytes

[[noreturn]] void no_stream() { throw std::length_error("no stream of columns"); }

void append(std::string& out, std::uint64_t number) {
  std::array<char, sizeof number> bytes{};
  std::memcpy(bytes.data(), &number, sizeof number);
  out.append(bytes.data(), bytes.size());
}

void append(std::string& out, const std::vector<std::string>& texts) {
  append(out, texts.size());
  for (const std::string& text : texts) {
    append(out, text.size());
    out += text;
  }
}

std::string head(unsigned char kind, std::size_t bytes) {
  std::string out(1, static_cast<char>(kind));
  append(out, bytes);
  return out;
}

}  // namespace

void send_header(const SendBytes& send, const Hdf5Header& header) {
  std::string body;
  append(body, header.names);
  append(body, header.units);
  append(body, header.comments);
  append(body, header.notices);
  append(body, header.rows);
  append(body, header.time_from ? 1 : 0);
  append(body, static_cast<std::uint64_t>(header.time_from.value_or(0)));
  append(body, header.exact_time ? 1 : 0);
  send(head(static_cast<unsigned char>(ColumnStream::Kind::header), body.size()));
  send(body);
}

void send_values(const SendBytes& send, std::span<const double> values) {
  send(head(static_cast<unsigned char>(ColumnStream::Kind::values), values.size_bytes()));
  send({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

void send_refusal(const SendBytes& send, std::string_view why) {
  why = why.substr(0, kMostRefusal);
  send(head(static_cast<unsigned char>(ColumnStream::Kind::refusal), why.size()));
  send(why);
}

ColumnStream::ColumnStream(ReceiveBytes receive) : receive_(std::move(receive)) {
  const Message message = begin();
  if (message.kind == Kind::refusal) refused(message.bytes);
  if (message.kind != Kind::header) no_stream();
  header_.names = texts(kInputLimits.hdf5_columns, kLongestHdf5Name);
  header_.units = texts(kInputLimits.hdf5_columns, kLongestHdf5Name);
  header_.comments = texts(kMostHdf5Comments, kLongestHdf5Text);
  header_.notices = texts(kMostNotices, kLongestNotice);
  header_.rows = number();
  const std::uint64_t whole_time = number(), time_from = number(), exact_time = number();
  header_.exact_time = exact_time == 1;
  if (whole_time == 1) header_.time_from = static_cast<std::int64_t>(time_from);
  if (header_.names.empty() || header_.units.size() != header_.names.size() || header_.rows == 0 ||
      whole_time > 1 || exact_time > 1)
    no_stream();
  left_ = header_.rows;
}

void ColumnStream::values(std::uint64_t most, std::vector<double>& to) {
  const Message message = begin();
  if (message.kind == Kind::refusal) refused(message.bytes);
  if (message.kind != Kind::values || message.bytes % sizeof(double) != 0) no_stream();
  const std::size_t count = message.bytes / sizeof(double);
  if (count == 0 || count > kMostValues || count > most) no_stream();
  to.resize(count);
  take({reinterpret_cast<char*>(to.data()), message.bytes});
}

bool ColumnStream::next(std::vector<std::vector<double>>& block) {
  if (left_ == 0) return false;
  block.resize(header_.names.size());
  for (std::vector<double>& column : block) {
    values(left_, column);
    if (column.size() != block.front().size()) no_stream();
  }
  left_ -= block.front().size();
  return true;
}

void ColumnStream::take(std::span<char> to) {
  if (!receive_(to)) no_stream();
}

std::uint64_t ColumnStream::number() {
  std::uint64_t out = 0;
  take({reinterpret_cast<char*>(&out), sizeof out});
  return out;
}

ColumnStream::Message ColumnStream::begin() {
  char kind = 0;
  take({&kind, 1});
  return {static_cast<Kind>(kind), number()};
}

std::string ColumnStream::text(std::size_t most) {
  const std::uint64_t length = number();
  if (length > most || (text_bytes_ += length) > kMostText) no_stream();
  std::string out(length, '\0');
  take(out);
  return out;
}

std::vector<std::string> ColumnStream::texts(std::size_t most, std::size_t longest) {
  const std::uint64_t count = number();
  if (count > most) no_stream();
  std::vector<std::string> out;
  for (std::uint64_t i = 0; i < count; ++i) out.push_back(text(longest));
  return out;
}

void ColumnStream::refused(std::size_t bytes) {
  if (bytes > kMostRefusal) no_stream();
  std::string why(bytes, '\0');
  take(why);
  throw std::runtime_error(printable(why, kMostRefusal));
}

}  // namespace ifog

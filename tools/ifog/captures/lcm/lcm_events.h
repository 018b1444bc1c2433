// SPDX-License-Identifier: Apache-2.0
// Events of a log written by lcm-logger. A damaged part is skipped and counted, and reading continues with
// the next event. An event must be followed by another one or by the end. LCM's own reader (1.3) stops at
// damage and trusts every length in the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/files/input_file.h"
#include "drivers/system/unnamed_file.h"

namespace ifog::tools {

// The type hash at the beginning of a message; 0 if it is too short.
std::int64_t type_hash(std::span<const std::uint8_t> message);

// Format, lcm-logger(1) and lcm/eventlog.h: big-endian 0xEDA1DA01, number and time (64 bits each), lengths of
// channel and data (32 bits each), channel, data.
class LcmEvents {
 public:
  struct Event {
    std::int64_t number = 0, timestamp_us = 0;
    std::string channel;
    std::span<const std::uint8_t> data;
  };

  // Throws std::runtime_error with one line if it cannot open the file.
  explicit LcmEvents(const std::string& path);

  // Valid until the next call; null at the end. Throws std::runtime_error with one line if reading fails.
  const Event* next();

  [[nodiscard]] std::size_t size() const { return size_; }  // bytes
  [[nodiscard]] std::size_t at() const { return at_; }      // first byte after the last event
  // Bytes between events that belong to none; also the number of such places and the first one.
  [[nodiscard]] std::size_t damaged() const { return damaged_; }
  [[nodiscard]] std::size_t places() const { return places_; }
  [[nodiscard]] std::size_t first_place() const { return first_place_; }
  // After reading to the end: reports bytes that belong to no event on standard error.
  void say_damage(const std::string& path) const;

 private:
  // Up to `bytes` bytes from there, fewer only at the end; valid until the next call.
  std::span<const std::uint8_t> window(std::size_t from, std::size_t bytes);
  bool read_event(std::size_t from);
  [[noreturn]] void fail() const;
  // Position of the magic number at the beginning of an event, in [from, to).
  std::optional<std::size_t> magic_in(std::size_t from, std::size_t to);

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t size_ = 0, at_ = 0;
  std::size_t damaged_ = 0, places_ = 0, first_place_ = 0;
  Event event_;
  std::vector<std::uint8_t> read_;  // part of the file, up to the next read
  std::size_t read_from_ = 0;
};

// Path of a log, which is read several times. A packed log, a pipe or a flight recording is copied to an
// unnamed temporary file.
class NamedLog {
 public:
  // Throws std::runtime_error with one line: no space, or the file cannot be read.
  explicit NamedLog(InputFile& file);
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  void unpack_messages(InputFile& file) const;

  std::string name_;
  std::optional<UnnamedFile> unpacked_;
};

// True if the file is a flight recording of LCM messages; reads only its head.
bool recorded_messages(const InputFile& file);

}  // namespace ifog::tools

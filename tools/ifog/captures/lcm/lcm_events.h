// SPDX-License-Identifier: Apache-2.0
// The events of a log made by lcm-logger, also of one that is damaged: what stands behind the damage is read
// again from the next event on, and what lies between is counted. An event that neither another follows nor
// the end is none. LCM's own reader (1.3) ends at the damage, and believes every length that it finds there.
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

// The hash of its type that a message begins with, 0 for one that is too short.
std::int64_t type_hash(std::span<const std::uint8_t> message);

// lcm-logger(1), lcm/eventlog.h: big-endian 0xEDA1DA01, number and time (64 bits each), lengths of channel
// and data (32 bits each), channel, data.
class LcmEvents {
 public:
  struct Event {
    std::int64_t number = 0, timestamp_us = 0;
    std::string channel;
    std::span<const std::uint8_t> data;
  };

  // Throws std::runtime_error with one line: cannot be opened.
  explicit LcmEvents(const std::string& path);

  // Until the next call; null at the end. Throws std::runtime_error with one line: the device fails.
  const Event* next();

  [[nodiscard]] std::size_t size() const { return size_; }  // bytes
  [[nodiscard]] std::size_t at() const { return at_; }      // byte behind the last event
  // Bytes that belong to no event, with events behind them, in so many places, the first from this byte on.
  [[nodiscard]] std::size_t damaged() const { return damaged_; }
  [[nodiscard]] std::size_t places() const { return places_; }
  [[nodiscard]] std::size_t first_place() const { return first_place_; }
  // What of a log that was read to its end is in no event, to standard error; nothing where all is.
  void say_damage(const std::string& path) const;

 private:
  // At most so many bytes from there on, fewer only at the end; until the next call.
  std::span<const std::uint8_t> window(std::size_t from, std::size_t bytes);
  bool read_event(std::size_t from);
  [[noreturn]] void fail() const;
  // Where the four bytes stand that every event begins with, in [from, to).
  std::optional<std::size_t> magic_in(std::size_t from, std::size_t to);

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t size_ = 0, at_ = 0;
  std::size_t damaged_ = 0, places_ = 0, first_place_ = 0;
  Event event_;
  std::vector<std::uint8_t> read_;  // of the file, up to where the next read goes on
  std::size_t read_from_ = 0;
};

// A log of LCM messages under a name, because it is read several times. One that comes packed, through a pipe or as a
// flight recording is kept in a file without a name of its own, which only this process knows.
class NamedLog {
 public:
  // Throws std::runtime_error with one line: no room for it, or it cannot be read.
  explicit NamedLog(InputFile& file);
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  void unpack(InputFile& file);
  void unpack_messages(InputFile& file) const;

  std::string name_;
  std::optional<UnnamedFile> unpacked_;
};

// Whether a file is a flight recording that holds LCM messages. It looks at the file's head and reads nothing.
bool recorded_messages(const InputFile& file);

}  // namespace ifog::tools

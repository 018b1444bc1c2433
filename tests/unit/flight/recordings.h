// SPDX-License-Identifier: Apache-2.0
// Recordings for tests, in memory, and what reading them gives.
#pragma once

#include "drivers/flight/archive.h"
#include "drivers/flight/flight_reader.h"
#include "tests/unit/test.h"

namespace ifog {

inline constexpr std::int64_t kSecond = 1'000'000'000, kDay = 86'400 * kSecond;
inline constexpr std::int64_t kWall = 1'700'000'000 * kSecond;  // 2023-11-14T22:13:20Z

// A folder in memory with a limit of its own, which may change, and a disk that may refuse.
struct MemoryDisk {
  std::map<std::string, std::vector<std::uint8_t>> files;
  std::map<std::string, std::int64_t> modified_ns;
  std::uint64_t room = UINT64_MAX;  // for all files together
  int refuses = 0;                  // errno of every append, 0: none
  int gone = 0;                     // errno of everything, 0: it is there
  bool cuts_back = true;            // a part that did not fit is taken back
  std::int64_t now_ns = 0;
  std::string open;  // name of the open file

  [[nodiscard]] std::uint64_t used() const {
    std::uint64_t sum = 0;
    for (const auto& [name, bytes] : files) sum += bytes.size();
    return sum;
  }
};

class MemoryFolder final : public FlightFolder {
 public:
  explicit MemoryFolder(MemoryDisk& disk) : disk_(disk) {}
  int list(std::vector<File>& out) override {
    out.clear();
    if (disk_.gone != 0) return disk_.gone;
    for (const auto& [name, bytes] : disk_.files)
      out.push_back({name, bytes.size(), disk_.modified_ns[name]});
    return 0;
  }
  int begin(const std::string& name) override {
    if (disk_.gone != 0) return disk_.gone;
    if (disk_.files.contains(name)) return EEXIST;
    disk_.files[name];
    disk_.modified_ns[name] = disk_.now_ns;
    disk_.open = name;
    return 0;
  }
  int append(std::span<const std::uint8_t> bytes) override {
    if (disk_.open.empty()) return EBADF;
    if (disk_.gone != 0) return disk_.gone;
    if (disk_.refuses != 0) return disk_.refuses;
    if (!disk_.files.contains(disk_.open)) {
      disk_.open.clear();
      return ENOENT;
    }
    std::vector<std::uint8_t>& file = disk_.files[disk_.open];
    if (const std::uint64_t used = disk_.used(); used + bytes.size() > disk_.room) {
      if (!disk_.cuts_back) {
        file.insert(file.end(), bytes.begin(),
                    bytes.begin() + static_cast<std::ptrdiff_t>(disk_.room - used));
        disk_.open.clear();
      }
      return ENOSPC;
    }
    file.insert(file.end(), bytes.begin(), bytes.end());
    disk_.modified_ns[disk_.open] = disk_.now_ns;
    return 0;
  }
  int finish(const std::string& name) override {
    if (disk_.open.empty()) return EBADF;
    return take_over(std::exchange(disk_.open, ""), name);
  }
  void leave() override { disk_.open.clear(); }
  int take_over(const std::string& open_name, const std::string& name) override {
    if (open_name == disk_.open) return EBUSY;
    if (disk_.gone != 0) return disk_.gone;
    disk_.files[name] = std::move(disk_.files[open_name]);
    disk_.files.erase(open_name);
    disk_.modified_ns[name] = disk_.modified_ns[open_name];
    return 0;
  }
  int remove(const std::string& name) override {
    if (disk_.gone != 0) return disk_.gone;
    return disk_.files.erase(name) == 1 ? 0 : ENOENT;
  }
  [[nodiscard]] std::string path() const override { return "memory"; }

 private:
  MemoryDisk& disk_;
};

// Entry n of a stream that any part of can be judged by: its number and some bytes that follow from it.
inline std::vector<std::uint8_t> numbered(std::uint64_t n, std::size_t most = 60) {
  std::vector<std::uint8_t> out(8 + n * 7919 % (most + 1));
  std::memcpy(out.data(), &n, sizeof n);
  std::minstd_rand random(static_cast<unsigned>(n + 1));
  for (std::size_t i = 8; i < out.size(); ++i) out[i] = static_cast<std::uint8_t>(random() >> 8U);
  return out;
}

struct ReadBack {
  std::vector<std::vector<std::uint8_t>> payloads;  // of `bytes` entries
  std::vector<std::size_t> holes;                   // before which of them
  std::vector<FlightHeader> headers;
  FlightCounts counts;
};

inline ReadBack read_back(const std::vector<std::uint8_t>& recording) {
  FlightReader reader(recording);
  ReadBack out;
  for (auto item = reader.next(); item != FlightReader::Item::end; item = reader.next()) {
    if (item == FlightReader::Item::header) out.headers.push_back(reader.header());
    if (item == FlightReader::Item::hole) out.holes.push_back(out.payloads.size());
    if (item == FlightReader::Item::entry && reader.entry().head.kind == FlightKind::bytes)
      out.payloads.emplace_back(reader.entry().payload.begin(), reader.entry().payload.end());
  }
  out.counts = reader.counts();
  return out;
}

// The numbers of what was read back.
inline std::vector<std::uint64_t> numbers(const ReadBack& read) {
  std::vector<std::uint64_t> out;
  for (const auto& payload : read.payloads) {
    out.emplace_back();
    std::memcpy(&out.back(), payload.data(), 8);
    EXPECT_EQ(payload, numbered(out.back()));
  }
  return out;
}

inline std::vector<std::uint64_t> counting(std::uint64_t from, std::uint64_t to) {
  std::vector<std::uint64_t> out;
  for (; from < to; ++from) out.push_back(from);
  return out;
}

// All files of the disk in their order, one behind the other.
inline std::vector<std::uint8_t> all_of(const MemoryDisk& disk) {
  std::vector<std::uint8_t> out;
  for (const auto& [name, bytes] : disk.files) out.insert(out.end(), bytes.begin(), bytes.end());
  return out;
}

inline FlightHeader some_header() {
  FlightHeader out;
  out.program = "1";
  out.sensor = "nose";
  out.source = "/dev/ttyUSB0";
  out.interface = "vcan1";
  out.driver = "kvh1750";
  out.options = {{"format", "b"}, {"rate_hz", "200"}};
  out.channels = {"supply_V", "coil_degC"};
  out.powered_ns = 1'795'000'000'123'456'789;
  out.boot = "0f8fad5bd9cb469fa16570867728950e";
  out.configuration = "[[sensor]]\nname = \"nose\"\npath = 'C:\\new'\n";
  out.configuration_file = "/etc/ifogd/ifogd.toml";
  out.files = {{"/etc/model.toml", std::string("a=b\n\\n\0c", 9)}};
  return out;
}

}  // namespace ifog

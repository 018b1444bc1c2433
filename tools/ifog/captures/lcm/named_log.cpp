// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/lcm/named_log.h"

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <string_view>
#include <vector>

#include "drivers/capture/recording.h"
#include "tools/ifog/captures/flight/flight_input.h"

namespace ifog::tools {

NamedLog::NamedLog(InputFile& file) : name_(file.path()) {
  const bool recorded = recorded_messages(file);
  if (file.reopens() && !recorded) return;
  unpacked_.emplace();
  name_ = "/proc/self/fd/" + std::to_string(unpacked_->descriptor());
  recorded ? unpack_messages(file) : unpack(file);
}

void NamedLog::unpack(InputFile& file) {
  constexpr std::size_t kBlock = std::size_t{1} << 20U;  // bytes
  std::vector<char> block(kBlock);
  std::size_t at = 0;
  while (const std::size_t n = file.read(block.data(), block.size())) {
    unpacked_->write(at, block.data(), n);
    at += n;
  }
}

void NamedLog::unpack_messages(InputFile& file) const {
  FlightInput flight(file);
  lcm::LogFile log(name_, "w");
  flight.for_each_entry([&](const FlightEntry& entry) {
    if (entry.head.kind != FlightKind::message || entry.head.index > entry.payload.size()) return;
    std::vector<std::uint8_t> data(entry.payload.begin() + entry.head.index, entry.payload.end());
    lcm::LogEvent event{};
    event.timestamp = entry.head.time_ns / 1000;
    event.channel.assign(reinterpret_cast<const char*>(entry.payload.data()), entry.head.index);
    event.datalen = static_cast<int>(data.size());
    event.data = data.data();
    if (log.writeEvent(&event) != 0) UnnamedFile::fail("cannot write");
  });
}

bool recorded_messages(const InputFile& file) {
  // The header's keys come in the order of drivers/flight/format.md, and no value has a line's end in it.
  return file_kind(file) == FileKind::flight &&
         file.head().find("\ncarries=messages\n") != std::string_view::npos;
}

}  // namespace ifog::tools

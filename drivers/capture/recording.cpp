#include "drivers/capture/recording.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <string_view>

#include "drivers/capture/candump.h"
#include "drivers/capture/text_file.h"

namespace ifog {

FileKind file_kind(const std::string& path) {
  std::string_view name(path);
  if (name.ends_with(".gz")) name.remove_suffix(3);
  if (name.ends_with(".csv")) return FileKind::capture;
  if (name.ends_with(".log") || name.ends_with(".candump")) return FileKind::candump;
  if (name.ends_with(".lcm")) return FileKind::lcm_log;
  for (const std::string_view ending : {".bin", ".kvh", ".raw", ".dat", ".txt"})
    if (name.ends_with(ending)) return FileKind::bytes;
  // lcm-logger's own names end in a number. Each event begins with this word.
  constexpr std::array<unsigned char, 4> kLcmEvent{0xED, 0xA1, 0xDA, 0x01};
  std::array<char, 4> first{};
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), first.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    if (!file || static_cast<unsigned char>(first[i]) != kLcmEvent[i]) return FileKind::unknown;
  return FileKind::lcm_log;
}

RecordingCounts decode_recording(const std::string& path, DriverInstance& driver,
                                 const std::string& interface,
                                 const std::function<void(const ifog_sample&)>& sink) {
  RecordingCounts counts;
  const auto take = [&](const ifog_sample& sample) {
    ++counts.samples;
    sink(sample);
  };
  if (driver.takes_can()) {
    const Candump log = read_candump(path, interface);
    counts.remote_frames = log.remote;
    counts.error_frames = log.error;
    counts.cut_off = log.cut_off;
    for (const ifog_can_frame& frame : log.frames) driver.decode_can(frame, take);
  } else {
    const std::string bytes = read_bytes_file(path);
    driver.decode_bytes({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, 0, take);
  }
  // What the driver still waited for will never come.
  const std::uint64_t before = driver.counters().bytes_skipped;
  driver.reset();
  counts.bytes_at_end = driver.counters().bytes_skipped - before;
  counts.driver = driver.counters();
  return counts;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/recording.h"

#include <string.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "drivers/capture/columns/column.h"
#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/files/file_kind.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20U;  // bytes

bool begins_as_hdf5(std::string_view head) {
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1A\n";
  for (const std::size_t at : {0U, 512U, 1024U, 2048U})
    if (head.substr(std::min<std::size_t>(at, head.size())).starts_with(kSignature)) return true;
  return false;
}

// Kind by a signature that no other kind has.
FileKind begun_as(std::string_view head) {
  if (head.starts_with("\xF1IFR")) return FileKind::flight;
  if (begins_as_hdf5(head) || begins_as_utf16(head)) return FileKind::capture;
  // First bytes of each LCM event; lcm-logger's file names end in a number.
  if (head.starts_with("\xED\xA1\xDA\x01")) return FileKind::lcm_log;
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  // Comments may precede a capture's header or a log's lines.
  while (head.starts_with('#') || head.starts_with('\n') || head.starts_with("\r\n"))
    head.remove_prefix(std::min(head.find('\n'), head.size() - 1) + 1);
  if (head.starts_with("time_s") || head.starts_with("\"time_s\"")) return FileKind::capture;
  CandumpEntry entry;
  return parse_candump_line(head.substr(0, head.find('\n')), entry) == CandumpLine::frame ? FileKind::candump
                                                                                          : FileKind::unknown;
}

// Text has no control characters except line ends, tabs and terminal colours.
bool is_text(std::string_view head) {
  return std::ranges::all_of(head, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte >= 0x20 && byte != 0x7F) || (byte >= '\t' && byte <= '\r') || byte == 0x1B;
  });
}

}  // namespace

bool is_hdf5(const std::string& path) {
  const std::string_view name = unpacked_name(path);
  return boost::iends_with(name, ".h5") || boost::iends_with(name, ".hdf5");
}

// By its name, unless the content contradicts; a user block may precede the signature.
bool is_hdf5(const InputFile& file) {
  if (begins_as_hdf5(file.head())) return true;
  return is_hdf5(file.path()) && begun_as(file.head()) == FileKind::unknown;
}

FileKind file_kind(const std::string& path) {
  using enum FileKind;
  constexpr std::array<std::pair<std::string_view, FileKind>, 5> kEndings = {
      {{".csv .h5 .hdf5 ", capture},
       {".log .candump ", candump},
       {".lcm ", lcm_log},
       {".ifr ", flight},
       {".bin .kvh .raw .dat .txt ", bytes}}};
  const std::string_view name = unpacked_name(path);
  const std::string ending = lower(std::string(name.substr(std::min(name.rfind('.'), name.size())))) + " ";
  for (const auto& [endings, kind] : kEndings)
    if (ending != " " && endings.find(ending) != std::string_view::npos) return kind;
  return unknown;
}

FileKind file_kind(const InputFile& file) {
  if (const FileKind begun = begun_as(file.head()); begun != FileKind::unknown) return begun;
  const std::string_view name = unpacked_name(file.path());
  const bool says_nothing = boost::iends_with(name, ".txt") || boost::iends_with(name, ".dat");
  FileKind by_name = says_nothing ? FileKind::unknown : file_kind(file.path());
  // Many programs use this ending: a line near the beginning is a frame, though the first may be incomplete.
  const auto any = [](const ifog_can_frame&) { return true; };
  if (by_name == FileKind::candump && !file.head().empty() && first_interface(file.head(), any).empty())
    by_name = FileKind::unknown;
  return by_name == FileKind::unknown && !is_text(file.head()) ? FileKind::bytes : by_name;
}

bool wants(const ifog_description& description, const ifog_can_frame& frame) {
  const bool extended = (frame.flags & IFOG_CAN_EXTENDED) != 0;
  const auto* const end = description.can_id + description.can_ids;
  return description.can_ids == 0 || std::any_of(description.can_id, end, [&](const auto& wanted) {
           return wanted.id == frame.id && (wanted.extended != 0) == extended;
         });
}

RecordingCounts decode_recording(InputFile& file, DriverInstance& driver, const std::string& interface,
                                 const std::function<void(const ifog_sample&)>& sink) {
  RecordingCounts counts;
  const auto take = [&](const ifog_sample& sample) {
    ++counts.samples;
    sink(sample);
  };
  if (driver.takes_can()) {
    counts.candump = for_each_candump_frame(
        file, interface, [&](const ifog_can_frame& frame) { return wants(driver.description(), frame); },
        [&](const ifog_can_frame& frame, std::string_view) { driver.decode_can(frame, take); });
  } else {
    std::vector<char> bytes(kPiece);
    while (const std::size_t n = file.read_what_is_there(bytes.data(), bytes.size()))
      driver.decode_bytes({reinterpret_cast<const std::uint8_t*>(bytes.data()), n}, 0, take);
  }
  finish_recording(driver, counts);
  counts.packed_ends_early = file.ends_early();
  return counts;
}

void finish_recording(DriverInstance& driver, RecordingCounts& counts) {
  const std::uint64_t before = driver.counters().bytes_skipped;
  driver.reset();
  counts.bytes_at_end = driver.counters().bytes_skipped - before;
  counts.driver = driver.counters();
}

std::vector<std::string> losses(const RecordingCounts& counts) {
  std::vector<std::string> lines;
  const auto say = [&](std::uint64_t n, const char* what) {
    if (n != 0) lines.push_back(std::to_string(n) + " " + what);
  };
  say(counts.driver.frames_crc, "frames with a wrong checksum");
  say(counts.driver.frames_format, "frames or samples that are not as the format or the options say");
  say(counts.driver.bytes_skipped - counts.bytes_at_end, "bytes that are part of no frame");
  say(counts.bytes_at_end, "bytes at the end are no whole frame (is the file cut off?)");
  say(counts.driver.frames_repeated, "frames dropped because they came twice");
  say(counts.driver.samples_incomplete, "samples dropped because some of their frames are missing");
  if (const ifog_driver_counters& driver = counts.driver; driver.values_beyond > 0)
    lines.push_back(
        std::to_string(driver.values_beyond) +
        " values are beyond the range that their description states, and kept: " +
        printable({driver.beyond_name, ::strnlen(driver.beyond_name, sizeof driver.beyond_name)}) + " is " +
        shortest(driver.beyond_value) + ", stated [" + shortest(driver.beyond_minimum) + ", " +
        shortest(driver.beyond_maximum) + "]");
  say(counts.packed_ends_early ? 1 : 0, "gzip stream ends early (truncated file); what is there was read");
  say(counts.candump.cut_off ? 1 : 0, "line at the end is no whole frame (is the file cut off?)");
  say(counts.candump.remote, "CAN remote frames skipped");
  say(counts.candump.error, "CAN error frames skipped");
  say(counts.candump.dropped, "CAN frames were dropped before candump could read them, according to the log");
  return lines;
}

}  // namespace ifog

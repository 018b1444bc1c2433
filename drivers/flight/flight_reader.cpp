// SPDX-License-Identifier: Apache-2.0
#include "drivers/flight/flight_reader.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "drivers/system/nanoseconds.h"

namespace ifog {
namespace {

constexpr std::size_t kPortion = 1U << 16U;

}  // namespace

FlightReader::FlightReader(std::span<const std::uint8_t> recording)
    : FlightReader(Source([rest = recording](char* to, std::size_t most) mutable {
        const std::size_t n = std::min(most, rest.size());
        std::copy_n(rest.begin(), n, to);
        rest = rest.subspan(n);
        return n;
      })) {}

bool FlightReader::ensure(std::size_t bytes) {
  if (stream_.at > (kPortion << 4U)) {
    stream_.held.erase(0, stream_.at);
    stream_.at = 0;
  }
  while (stream_.held.size() - stream_.at < bytes && !stream_.ended) {
    const std::size_t before = stream_.held.size();
    stream_.held.resize(before + kPortion);
    const std::size_t got = stream_.read(stream_.held.data() + before, kPortion);
    stream_.held.resize(before + got);
    stream_.ended = got < kPortion;
  }
  return stream_.held.size() - stream_.at >= bytes;
}

void FlightReader::drop(std::size_t bytes) {
  stream_.at += bytes;
  stream_.passed += bytes;
}

// Reads the valid block that starts here into block_ and content_: of this file, or the header of another.
bool FlightReader::block_here() {
  if (!ensure(kBlockHead)) return false;
  for (const bool header : {false, true}) {
    const BlockPlace place = header ? BlockPlace{} : BlockPlace{header_.file, stream_.passed - file_.at};
    if (!header && !file_.begun) continue;
    if (!read_block_head(ahead(), place, block_) || (block_.type == BlockType::header) != header) continue;
    if (!ensure(block_.size()) || !read_block(ahead().first(block_.size()), place, block_, content_))
      continue;
    header_block_ = header;
    return true;
  }
  return false;
}

FlightReader::Found FlightReader::next_block() {
  std::uint64_t skipped = 0;
  while (!block_here()) {
    if (!ensure(1)) break;
    // Skips to the next possible start of a block.
    const std::span<const std::uint8_t> bytes = ahead();
    const void* const next =
        bytes.size() > 1 ? std::memchr(bytes.data() + 1, kBlockSync & 0xFFU, bytes.size() - 1) : nullptr;
    const std::size_t step =
        next == nullptr ? bytes.size()
                        : static_cast<std::size_t>(static_cast<const std::uint8_t*>(next) - bytes.data());
    skipped += step;
    drop(step);
  }
  const bool ended = !ensure(1);
  if (!file_.begun && (ended || skipped > 0))
    throw std::runtime_error("is no flight recording, expected one that begins with its header");
  if (skipped == 0) return ended ? Found::end : Found::block;
  file_.whole = false;
  (ended || header_block_ ? counts_.torn_bytes : counts_.damaged_bytes) += skipped;
  return ended ? Found::end : Found::gap;
}

void FlightReader::finish_file(bool another_run) {
  if (!file_.begun) return;
  if (another_run)
    counts_.cut_off_runs += !file_.closed || file_.run_goes_on ? 1 : 0;
  else
    counts_.open_files += file_.closed ? 0 : 1;
}

FlightReader::Item FlightReader::begin_file() {
  FlightHeader fresh = parse_header(content_);
  // The next file of a run may start within a frame.
  const bool goes_on = file_.begun && file_.closed && file_.whole && fresh.run == header_.run &&
                       fresh.number == header_.number + 1;
  const bool first = !file_.begun;
  const bool same_run = !first && fresh.run == header_.run;
  if (same_run && fresh.number > header_.number + 1)
    counts_.missing_files += fresh.number - header_.number - 1;
  if (!first && !same_run && file_.closed && fresh.opened_ns < file_.closed_ns) ++counts_.early_files;
  finish_file(!first && !same_run);
  if (!same_run) {
    ++counts_.runs;
    end_run();
  }
  header_ = std::move(fresh);
  file_ = {.at = stream_.passed, .begun = true};
  ++counts_.files;
  drop(block_.size());
  if (first || goes_on) return Item::header;
  header_due_ = true;
  return Item::hole;
}

// Data blocks become entries; an end is compared with what was read.
void FlightReader::take_block() {
  drop(block_.size());
  if (block_.type == BlockType::data) {
    ++counts_.blocks;
    rest_ = content_;
    return;
  }
  const FlightEntry end{{}, content_};
  std::uint64_t stated = 0, goes_on = 0;
  file_.closed = true;
  file_.closed_ns = INT64_MIN;
  end.value(stated);
  end.value(file_.closed_ns, sizeof stated);
  end.value(goes_on, sizeof stated + sizeof file_.closed_ns);
  file_.run_goes_on = goes_on != 0;
  if (stated > file_.entries) {
    counts_.missing_entries += stated - file_.entries;
    file_.whole = false;
  }
}

// Time between runs by the wall clock at the end of each run: a computer without a battery-backed clock
// starts in 1970 and is set some seconds later. Without a valid wall clock the time is unknown.
void FlightReader::note_arrival() {
  const FlightEntryHead& head = entry_.head;
  if (std::int64_t set_ns = 0; head.kind == FlightKind::wall && entry_.value(set_ns))
    run_.wall_set_ns = set_ns;
  if (!head.is_received() || head.time_ns <= 0) return;
  if (run_.began_ns == 0) run_.began_ns = head.time_ns;
  run_.arrived_ns = head.time_ns;
}

void FlightReader::end_run() {
  constexpr std::int64_t kClockIsSet_ns = 631'152'000'000'000'000;  // 1990: no such computer is older
  if (run_.began_ns == 0) return;
  const std::int64_t began_ns = ns_after(run_.began_ns, run_.wall_set_ns);
  const std::int64_t pause_ns = ns_between(run_.last_ended_ns, began_ns);
  const bool alike = (run_.last_ended_ns < kClockIsSet_ns) == (began_ns < kClockIsSet_ns);
  if (run_.last_ended_ns > 0 && alike && pause_ns > 0) {
    const double pause_s = static_cast<double>(pause_ns) * 1e-9;
    counts_.between_runs_s += pause_s;
    counts_.longest_between_runs_s = std::max(counts_.longest_between_runs_s, pause_s);
  }
  run_.last_ended_ns = ns_after(run_.arrived_ns, run_.wall_set_ns);
  run_.began_ns = run_.wall_set_ns = 0;
}

// False: the entry reports a loss.
bool FlightReader::take_entry_ahead() {
  if (!take_entry(rest_, entry_)) {
    // The checksum is right, so the writer was faulty or is a later version.
    counts_.damaged_bytes += rest_.size();
    rest_ = {};
    file_.whole = false;
    return false;
  }
  ++counts_.entries;
  ++file_.entries;
  note_arrival();
  if (std::uint64_t merged = 0; entry_.head.kind == FlightKind::merged && entry_.value(merged))
    counts_.merged_samples += merged;
  if (entry_.head.kind != FlightKind::lost) return true;
  std::uint64_t deliveries = 0, bytes = 0;
  if (entry_.value(deliveries) && entry_.value(bytes, sizeof deliveries)) {
    const bool messages = header_.carries == FlightHeader::Carries::messages;
    (messages ? counts_.lost_messages : counts_.lost_deliveries) += deliveries;
    counts_.lost_bytes += messages ? 0 : bytes;
  }
  return false;
}

FlightReader::Item FlightReader::next() {
  if (std::exchange(header_due_, false)) return Item::header;
  while (!ended_) {
    if (!rest_.empty()) return take_entry_ahead() ? Item::entry : Item::hole;
    const Found found = next_block();
    if (found == Found::end) {
      finish_file(false);
      end_run();
      ended_ = true;
    } else if (header_block_) {
      return begin_file();
    } else if (found == Found::gap) {
      return Item::hole;  // the block after it comes with the next call
    } else {
      take_block();
    }
  }
  return Item::end;
}

std::vector<std::string> losses(const FlightCounts& counts) {
  std::vector<std::string> lines;
  const auto say = [&](std::uint64_t n, const std::string& what) {
    if (n != 0) lines.push_back(std::to_string(n) + " " + what);
  };
  say(counts.damaged_bytes, "bytes are damaged and were skipped");
  say(counts.torn_bytes, "bytes at the end of a recording are no whole block (what wrote it was killed)");
  say(counts.open_files, "recording(s) without an end: still being written, or what wrote it was killed");
  say(counts.cut_off_runs,
      "run(s) of what wrote it were cut off (killed, or the computer was switched off): up to a second at "
      "the end of each is missing");
  if (counts.between_runs_s > 0.0) {
    std::array<char, 160> line{};
    std::snprintf(
        line.data(), line.size(),
        "runs of what wrote it, with %.6g s between them that are not recorded, %.6g s at the longest",
        counts.between_runs_s, counts.longest_between_runs_s);
    say(counts.runs, line.data());
  }
  say(counts.missing_entries, "entries are missing by the recording's own count");
  say(counts.lost_deliveries, "deliveries (" + std::to_string(counts.lost_bytes) +
                                  " bytes) were received and not recorded: the disk was slow or full");
  say(counts.lost_messages,
      "messages are not in the recording: lost on LCM on the way to it, or the disk was slow or full");
  say(counts.missing_files, "recording(s) between the first and the last are not there");
  say(counts.early_files,
      "recording(s) begun before the one in front had ended: two recorders wrote at once, or the clock was "
      "set back");
  return lines;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// Reads a flight recording, or several one after another, entry by entry, whatever happened to it: what is
// torn or damaged is skipped and counted, and never read as data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "drivers/flight/block.h"
#include "drivers/flight/entry.h"
#include "drivers/flight/header.h"

namespace ifog {

struct FlightCounts {
  std::uint64_t files = 0, blocks = 0, entries = 0;
  std::uint64_t damaged_bytes = 0;  // in the middle of a file
  std::uint64_t torn_bytes = 0;     // at the end of a file: a block that was not written whole
  // Without an end, and nothing of another run behind it: still written, or what wrote it was killed.
  std::uint64_t open_files = 0;
  std::uint64_t missing_entries = 0;  // that a file's end tells of and are not there
  std::uint64_t lost_deliveries = 0,
                lost_bytes = 0;      // that were received and not recorded: the disk was too slow
  std::uint64_t lost_messages = 0;   // the same of a recording of messages: LCM or the disk was too slow
  std::uint64_t missing_files = 0;   // of a run, between those that are there
  std::uint64_t early_files = 0;     // begun before the one in front of them had ended, in another run
  std::uint64_t merged_samples = 0;  // before the filter, see FlightKind::merged
  // Runs of the recorder; those without an end that another follows; and the time from the last entry of one
  // to the first of the next.
  std::uint64_t runs = 0, cut_off_runs = 0;
  double between_runs_s = 0.0, longest_between_runs_s = 0.0;
};

class FlightReader {
 public:
  // As InputFile::read: up to so many bytes, fewer only at the end.
  using Source = std::function<std::size_t(char*, std::size_t)>;
  explicit FlightReader(Source source) : stream_{std::move(source), {}} {}
  // Reads a recording in memory, which must stay as it is while the reader is used.
  explicit FlightReader(std::span<const std::uint8_t> recording);

  enum class Item {
    header,  // a file begins: header()
    entry,   // entry(), valid until the next call; `lost` never comes, but as a hole
    hole,    // between what came and what comes something is missing: forget half-read frames
    end,
  };
  // Throws std::runtime_error, without the file's name: no flight recording, or one of another version.
  Item next();

  [[nodiscard]] const FlightHeader& header() const { return header_; }
  [[nodiscard]] const FlightEntry& entry() const { return entry_; }
  [[nodiscard]] const FlightCounts& counts() const { return counts_; }

 private:
  enum class Found { block, gap, end };
  bool ensure(std::size_t bytes);
  void drop(std::size_t bytes);
  bool block_here();
  Found next_block();
  Item begin_file();
  void take_block();
  bool take_entry_ahead();
  void finish_file(bool another_run);
  void note_arrival();
  void end_run();
  [[nodiscard]] std::span<const std::uint8_t> ahead() const {
    return {reinterpret_cast<const std::uint8_t*>(stream_.held.data()) + stream_.at,
            stream_.held.size() - stream_.at};
  }

  struct Stream {
    Source read;
    std::string held;
    std::size_t at = 0;        // in held
    std::uint64_t passed = 0;  // bytes of the stream before held[at]
    bool ended = false;
  };
  // The present file, or the last one.
  struct File {
    std::uint64_t at = 0;       // where it begins in the stream
    std::uint64_t entries = 0;  // so far
    bool begun = false, closed = false;
    bool whole = true;           // nothing of it is missing
    bool run_goes_on = false;    // by its end, in another file
    std::int64_t closed_ns = 0;  // wall clock, once it is closed
  };
  struct Run {
    // Arrival of its first and last entry, 0: none has a known time; by how much its wall clock was set.
    std::int64_t began_ns = 0, arrived_ns = 0, wall_set_ns = 0;
    std::int64_t last_ended_ns = 0;  // the run before, by the wall clock; 0: there was none
  };

  Stream stream_;
  FlightHeader header_;
  FlightCounts counts_;
  File file_;
  Run run_;
  bool header_due_ = false, ended_ = false;
  BlockHead block_;
  bool header_block_ = false;
  std::vector<std::uint8_t> content_;
  std::span<const std::uint8_t> rest_;  // of content_: entries to come
  FlightEntry entry_;
};

// "3 bytes damaged …", one line for each counter that says something is missing.
std::vector<std::string> losses(const FlightCounts& counts);

}  // namespace ifog

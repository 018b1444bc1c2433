// SPDX-License-Identifier: Apache-2.0
// Reads one or several flight recordings entry by entry. Torn or damaged data are skipped and counted.
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
  std::uint64_t torn_bytes = 0;     // at the end of a file: an incomplete block
  // Without an end, and not followed by another run: still being written, or the writer was killed.
  std::uint64_t open_files = 0;
  std::uint64_t missing_entries = 0;  // according to a file's end
  std::uint64_t lost_deliveries = 0,
                lost_bytes = 0;      // received but not recorded: the disk was too slow
  std::uint64_t lost_messages = 0;   // the same for a recording of messages
  std::uint64_t missing_files = 0;   // of a run, between existing ones
  std::uint64_t early_files = 0;     // started before the previous one had ended, in another run
  std::uint64_t merged_samples = 0;  // before the filter, see FlightKind::merged
  // Runs of the recorder; runs without an end that are followed by another; time from the last entry of a run
  // to the first of the next.
  std::uint64_t runs = 0, cut_off_runs = 0;
  double between_runs_s = 0.0, longest_between_runs_s = 0.0;
};

class FlightReader {
 public:
  // As InputFile::read: up to this many bytes, fewer only at the end.
  using Source = std::function<std::size_t(char*, std::size_t)>;
  explicit FlightReader(Source source) : stream_{std::move(source), {}} {}
  // Reads a recording in memory, which must not change while the reader is used.
  explicit FlightReader(std::span<const std::uint8_t> recording);

  enum class Item {
    header,  // a file starts: header()
    entry,   // entry(), valid until the next call; losses are reported as `hole`
    hole,    // something is missing here: discard incomplete frames
    end,
  };
  // Throws std::runtime_error, without the file's name: no flight recording, or another version.
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
    std::size_t at = 0;        // index in held
    std::uint64_t passed = 0;  // bytes of the stream before held[at]
    bool ended = false;
  };
  // Present or last file.
  struct File {
    std::uint64_t at = 0;       // start in the stream
    std::uint64_t entries = 0;  // so far
    bool begun = false, closed = false;
    bool whole = true;           // no part is missing
    bool run_goes_on = false;    // it continues in another file, according to its end
    std::int64_t closed_ns = 0;  // wall clock
  };
  struct Run {
    // Arrival of its first and last entry, 0: unknown; change of its wall clock.
    std::int64_t began_ns = 0, arrived_ns = 0, wall_set_ns = 0;
    std::int64_t last_ended_ns = 0;  // end of the previous run by the wall clock; 0: none
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
  std::span<const std::uint8_t> rest_;  // remaining entries in content_
  FlightEntry entry_;
};

// One line for each counter of losses: "3 bytes damaged …".
std::vector<std::string> losses(const FlightCounts& counts);

}  // namespace ifog

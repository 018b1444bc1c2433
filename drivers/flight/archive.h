// SPDX-License-Identifier: Apache-2.0
// Stores recordings in a folder: entries become blocks, blocks become files, and the oldest files are removed
// if there are too many. Calls wait for the disk, so real-time threads must not use it.
//
// Files are called NUMBER-UTC.ifr, with .open appended while they are written; their order is that of the
// numbers, regardless of the wall clock. If the disk rejects writes nothing is lost at once: added data wait,
// and full() means that nothing more may be added.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/flight/block.h"
#include "drivers/flight/entry.h"
#include "drivers/flight/folder.h"
#include "drivers/flight/header.h"

namespace ifog {

struct ArchiveLimits {
  std::uint64_t bytes = 1'000'000'000;  // of all files together
  std::int64_t age_ns = 30LL * 86'400 * 1'000'000'000;
  std::uint64_t file_bytes = 16'000'000;
  std::int64_t file_ns = 3'600LL * 1'000'000'000;
  // Delay of writes: data are written at the first turn() this long after the turn that found them. With four
  // turns a second that is 0.75 s after arrival, so a killed process loses at most a second.
  std::int64_t flush_ns = 500'000'000;
};

// Received data that are in no recording.
struct FlightLoss {
  std::uint64_t deliveries = 0, bytes = 0;

  FlightLoss& operator+=(const FlightLoss& other) {
    deliveries += other.deliveries;
    bytes += other.bytes;
    return *this;
  }
};

class FlightArchive {
 public:
  // now_ns: unslewed clock. wall_ns: for names, and for the age of existing files.
  FlightArchive(std::unique_ptr<FlightFolder> folder, ArchiveLimits limits, FlightHeader header);
  ~FlightArchive();  // calls close() at the time of the last turn()

  // Appends an entry; only if not full(). begins_delivery: it is the first of one read.
  void add(const FlightEntryHead& head, std::span<const std::uint8_t> payload, bool begins_delivery = true);
  [[nodiscard]] bool full() const { return waiting_.bytes.size() >= kBlockTarget; }
  // Writes due data, starts and ends files, removes old ones. flush: all waiting data are due.
  void turn(std::int64_t now_ns, std::int64_t wall_ns, bool flush = false);
  // From the next block on; ends the present file.
  void set_header(FlightHeader header) { next_header_ = std::move(header); }
  // Writes waiting data and ends the file. Returns the number of entries lost because the disk rejects them.
  std::uint64_t close(std::int64_t now_ns, std::int64_t wall_ns);

  // errno of the disk's last answer, 0 if none; complaint() is the message, with what was expected.
  [[nodiscard]] int error() const { return error_; }
  [[nodiscard]] std::string complaint() const;
  // Losses: with files that were removed while being written, and data that were waiting at close().
  [[nodiscard]] const FlightLoss& lost_with_files() const { return lost_.with_files; }
  [[nodiscard]] const FlightLoss& lost_at_close() const { return lost_.waiting; }
  [[nodiscard]] std::uint64_t bytes_written() const { return bytes_written_; }
  [[nodiscard]] std::uint64_t files_removed() const { return kept_.removed; }
  [[nodiscard]] std::uint64_t entries_waiting() const { return waiting_.entries; }
  [[nodiscard]] std::string path() const { return folder_->path(); }

 private:
  struct Kept {
    std::uint64_t number;
    std::string name;
    std::uint64_t bytes;
    std::int64_t last_ns;  // last written, by the clock of now_ns
  };
  struct KeptFiles {
    std::deque<Kept> files;  // oldest first
    std::uint64_t bytes = 0;
    bool known = false;  // the folder's content is known
    std::uint64_t next_number = 1, removed = 0;
  };
  struct OpenFile {
    bool open = false;
    std::string name;  // final name
    std::uint64_t bytes = 0, entries = 0;
    std::int64_t since_ns = 0;
    FlightLoss load;  // deliveries in it
  };
  // Entries that are not in a file yet.
  struct Waiting {
    std::vector<std::uint8_t> bytes;
    std::uint64_t entries = 0;
    std::int64_t since_ns = -1;
    FlightLoss load;
  };
  struct Lost {
    FlightLoss with_files, waiting;
  };

  int look();
  int begin_file();
  int end_file(bool run_goes_on);
  int write(BlockType type, std::span<const std::uint8_t> content);
  int write_waiting();
  void remember_state();
  void forget_file();
  int remove_oldest();
  int tidy();
  [[nodiscard]] bool file_is_full() const;

  static constexpr std::size_t kBlockTarget = 1U << 16U;

  std::unique_ptr<FlightFolder> folder_;
  ArchiveLimits limits_;
  FlightHeader header_;
  std::optional<FlightHeader> next_header_;  // of the next file
  KeptFiles kept_;
  OpenFile file_;
  std::uint64_t began_ = 0;  // number of the run's first file
  Waiting waiting_;
  Deflater deflater_;
  std::int64_t now_ns_ = 0, wall_ns_ = 0;  // of the present or last turn
  // Latest value of each channel and the wall clock's shift: every file starts with them.
  std::map<std::pair<FlightKind, std::uint16_t>, std::vector<std::uint8_t>> state_;
  Lost lost_;
  int error_ = 0;
  std::uint64_t bytes_written_ = 0;
};

}  // namespace ifog

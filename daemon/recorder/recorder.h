// SPDX-License-Identifier: Apache-2.0
// Flight recorder of one sensor: an ordinary thread that writes the reader thread's tape to disk. A slow or
// full disk affects only the tape. It is not woken: it checks a few times a second.
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "daemon/recorder/tape.h"
#include "drivers/flight/archive.h"

namespace ifog {

class Recorder {
 public:
  // name: of the thread.
  Recorder(std::string name, std::size_t tape_bytes, std::unique_ptr<FlightFolder> folder,
           const ArchiveLimits& limits, FlightHeader header);
  ~Recorder();  // stops

  [[nodiscard]] Tape& tape() noexcept { return tape_; }
  // Throws std::system_error if no thread is available.
  void start();
  // After the reader thread's end: writes the rest of the tape and ends the file.
  void stop();
  // Sets the header of the file that starts at the tape's note of these settings (Tape::note_settings).
  void set_header(FlightHeader header, std::uint32_t settings);

  // Message for the log, once at the start and end of each problem; "" if nothing is new. good: it is over.
  [[nodiscard]] std::string take_message(bool& good);
  struct Counts {
    std::uint64_t file_bytes = 0, files_removed = 0, entries_unwritten = 0;
    // Deliveries lost: no space, removed while being written, or not accepted by the disk at the end.
    FlightLoss lost{};
  };
  // For any thread that may wait.
  [[nodiscard]] Counts counts() const;

  // One turn of the thread, at these times; for tests.
  void turn(std::int64_t now_ns, std::int64_t wall_ns);

 private:
  void run();
  void drain(std::int64_t now_ns, std::int64_t wall_ns, bool flush);
  void fill();
  bool begin_settings();
  // lost, unwritten: what is left on the tape at the end.
  void publish_counts(const FlightLoss& lost = {}, std::uint64_t unwritten = 0);
  void judge(std::int64_t now_ns);
  void judge_the_end(std::uint64_t deliveries);
  void say(std::string message, bool good);

  std::string name_;
  std::chrono::nanoseconds rest_;  // between two turns
  Tape tape_;
  FlightArchive archive_;
  std::vector<std::uint8_t> payload_;
  FlightLoss reported_;  // as read from the tape
  // Losses before the problem, and its beginning and end by turns.
  struct Trouble {
    bool present = false;
    std::int64_t judged_ns = 0, first_loss_ns = 0, last_loss_ns = 0;
    std::uint64_t lost_before = 0, lost_seen = 0, gone_seen = 0;
  } trouble_;
  std::uint32_t settings_due_ = 0;  // their file starts when all before is written

  mutable std::mutex mutex_;  // never locked by a real-time thread
  std::condition_variable stops_;
  std::map<std::uint32_t, FlightHeader> next_headers_;  // by the number of their settings
  struct Message {
    std::string text;
    bool good = false;
  } message_;

  Counts counts_;
  bool stopping_ = false;  // protected by mutex_
  std::thread thread_;
};

}  // namespace ifog

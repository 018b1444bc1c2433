// SPDX-License-Identifier: Apache-2.0
// Writes LCM messages into flight recordings and counts the lost ones, each once: lost here, or on the way
// from the daemon.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/flight/archive.h"
#include "tools/ifog/captures/lcm/lcm_loss.h"

namespace ifog::tools {

class MessageArchive {
 public:
  struct Books {
    std::uint64_t received = 0;     // messages
    std::uint64_t lost_here = 0;    // received but not stored: the disk was slow or full
    std::uint64_t lost_on_way = 0;  // rates that were not received, by their numbers
    std::uint64_t restarts = 0;     // LcmLoss::restarts()
    std::string two_publishers;     // channels that had two publishers, separated by commas
  };

  MessageArchive(std::unique_ptr<FlightFolder> folder, const ArchiveLimits& limits,
                 const FlightHeader& header)
      : archive_(std::move(folder), limits, header) {}

  // Creates and locks the folder. Throws std::runtime_error with one line and writes nothing if that fails.
  void open(std::int64_t now_ns, std::int64_t wall_ns);
  void take(const std::string& channel, std::span<const std::uint8_t> message, std::int64_t came_utime,
            std::int64_t now_ns, std::int64_t wall_ns);
  void turn(std::int64_t now_ns, std::int64_t wall_ns) { archive_.turn(now_ns, wall_ns); }
  // Ends the recording.
  void close(std::int64_t now_ns, std::int64_t wall_ns);

  [[nodiscard]] Books books() const;
  // State of its disk and of its files.
  [[nodiscard]] const FlightArchive& archive() const { return archive_; }

 private:
  void tell_lost(std::int64_t wall_ns);
  void look_at(const std::string& channel, std::span<const std::uint8_t> message);

  FlightArchive archive_;
  std::map<std::string, LcmLoss> ways_;
  std::vector<std::uint8_t> payload_;
  Books books_;
  std::uint64_t unreported_ = 0, unreported_bytes_ = 0;  // lost, and not yet noted in the recording
};

}  // namespace ifog::tools

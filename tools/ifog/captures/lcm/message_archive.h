// SPDX-License-Identifier: Apache-2.0
// LCM messages on their way into flight recordings, and the books of those that are in none: each is lost in
// one place, here or on the way from the daemon to here.
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
    std::uint64_t heard = 0;        // messages
    std::uint64_t lost_here = 0;    // heard, and in no recording: the disk was slow or full
    std::uint64_t lost_on_way = 0;  // rates that were not heard, by their numbers
    std::uint64_t began_anew = 0;   // LcmLoss::began_anew()
    std::string two_publishers;     // channels that had two at a time, with commas; "" for none
  };

  MessageArchive(std::unique_ptr<FlightFolder> folder, const ArchiveLimits& limits,
                 const FlightHeader& header)
      : archive_(std::move(folder), limits, header) {}

  // Makes the folder and has it alone. Throws std::runtime_error with one line where it cannot, and has then
  // written nothing.
  void open(std::int64_t now_ns, std::int64_t wall_ns);
  void take(const std::string& channel, std::span<const std::uint8_t> message, std::int64_t came_utime,
            std::int64_t now_ns, std::int64_t wall_ns);
  void turn(std::int64_t now_ns, std::int64_t wall_ns) { archive_.turn(now_ns, wall_ns); }
  // Ends the recording.
  void close(std::int64_t now_ns, std::int64_t wall_ns);

  [[nodiscard]] Books books() const;
  // Its disk and what it has written.
  [[nodiscard]] const FlightArchive& archive() const { return archive_; }

 private:
  void tell_lost(std::int64_t wall_ns);
  void look_at(const std::string& channel, std::span<const std::uint8_t> message);

  FlightArchive archive_;
  std::map<std::string, LcmLoss> ways_;
  std::vector<std::uint8_t> payload_;
  Books books_;
  std::uint64_t untold_ = 0, untold_bytes_ = 0;  // lost, and not yet said in the recording
};

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
// Converts CAN frames to samples by a DBC file. No allocation after construction.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/plugins/dbc/picks.h"

namespace ifog::dbc {

// A sample may consist of several frames; it is complete when every axis has arrived. The frames of different
// samples are distinguished by
//   - the counter, in frames that carry it;
//   - an axis that arrives a second time;
//   - if some axis's frame has no counter: the frame that begins a sample. By arrival times it is the one that
//   follows the longest pause, at least twice as long as before the frame assumed so far; at first that of the
//   lowest id, since queued frames are sent in the order of their ids (arbitration).
// So a lost frame never merges two samples: the incomplete one is dropped and counted. A repeated frame (same
// counter, same values) is ignored and counted; a repeated sample of one frame is passed on and detected
// later. A value beyond the range in the file ([min|max]) is kept, counted and flagged. Environment, status
// and time may be in other frames; they belong to the next complete sample.
class Decoder {
 public:
  explicit Decoder(const Picks& picks);

  void decode(const ifog_can_frame& frame, ifog_emit_sample emit, void* sink) noexcept;
  void reset() noexcept;

  // frames_other: ids without a picked signal. frames_format: too short for a signal. frames_good: all
  // others, including frames_repeated. samples_incomplete: incomplete samples, and frames without the
  // beginning of their sample.
  [[nodiscard]] const ifog_driver_counters& counters() const { return counters_; }

 private:
  struct Entry {
    Role role;
    std::size_t index;  // of the axis or environment channel
    const Message* message;
    const Signal* signal;
    std::size_t bytes;  // required length of the frame
  };
  struct Wanted {
    std::uint32_t id;
    bool extended;
    std::vector<Entry> entries;
  };

  void add(Role role, std::size_t index, const Pick& pick);
  void learn_order();
  void learn_pause(std::uint32_t brings, std::int64_t arrival_ns) noexcept;
  void take(const Wanted& wanted, const ifog_can_frame& frame, ifog_emit_sample emit, void* sink) noexcept;
  void set(const Entry& entry, std::span<const std::uint8_t> data) noexcept;
  [[nodiscard]] bool repeats(const Wanted& wanted, std::span<const std::uint8_t> data,
                             const double* known) const noexcept;
  [[nodiscard]] bool repeats_last() const noexcept;
  void judge(const Signal& signal, double value) noexcept;
  void begin_sample() noexcept;
  void give_up() noexcept;
  void complete(std::int64_t arrival_ns, ifog_emit_sample emit, void* sink) noexcept;

  const Picks& picks_;
  std::vector<Wanted> wanted_;
  std::uint32_t all_axes_ = 0;        // bit i: axis i
  std::uint32_t beginning_axes_ = 0;  // any of these begins a sample
  // Base-2 logarithm of the time, ns, from any axis's frame to the next one, with this axis.
  struct Pauses {
    std::array<double, IFOG_MAX_AXES> mean{}, count{};
    std::int64_t arrived_ns = -1;  // the last axis's frame; -1: none
  } pauses_;
  std::uint32_t present_ = 0;  // axes of the present sample
  std::uint32_t good_ = 0;     // of these, axes with a plausible value
  bool counted_ = false;       // its counter is known
  std::uint32_t frames_ = 0;   // number of frames with its axes
  // Last complete sample, if it had a counter. A counter that never changed does not distinguish samples.
  struct Last {
    bool counted = false;
    std::uint32_t sequence = 0;
    std::array<double, IFOG_MAX_AXES> value{};
  } last_;
  bool counter_moved_ = false;
  ifog_sample sample_{};
  bool timed_ = false;   // its clock was read
  bool beyond_ = false;  // since the last sample
  ifog_driver_counters counters_{};
};

}  // namespace ifog::dbc

// SPDX-License-Identifier: Apache-2.0
// From CAN frames to samples by a DBC file's description. No allocation after construction.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/plugins/dbc/picks.h"

namespace ifog::dbc {

// A sample may be spread over several frames; it is complete when every axis has arrived. The frames of one
// sample are distinguished from those of the next by
//   - the counter, in each frame that carries it;
//   - an axis that comes a second time;
//   - where some axis's frame carries no counter: the frame of the lowest id. It begins a sample, because
//     frames queued together leave in the order of their ids (arbitration).
// So when a frame is lost, no sample is made of two: what is left of it is dropped and counted. A frame that
// comes twice, same counter and same values, changes nothing and is counted too; a sample of one frame passes
// on, and whoever counts samples sees it. A value beyond the range that the file states ([min|max]) is kept,
// counted and flagged. Environment, status and time may be in frames of their own; they go with the next
// sample that completes.
class Decoder {
 public:
  explicit Decoder(const Picks& picks);

  void decode(const ifog_can_frame& frame, ifog_emit_sample emit, void* sink) noexcept;
  void reset() noexcept;

  // frames_other: of an id that no signal is picked from. frames_format: too short for a signal. frames_good:
  // all others, with frames_repeated among them. samples_incomplete: begun and given up, and frames whose
  // sample's beginning was lost.
  [[nodiscard]] const ifog_driver_counters& counters() const { return counters_; }

 private:
  enum class Role : std::uint8_t { kAxis, kCounter, kStatus, kTime, kEnvironment };
  struct Entry {
    Role role;
    std::size_t index;  // of the axis or the environment channel
    const Message* message;
    const Signal* signal;
    std::size_t bytes;   // the frame must have, for this signal
    double si_per_unit;  // axes only
  };
  struct Wanted {
    std::uint32_t id;
    bool extended;
    std::vector<Entry> entries;
  };

  void add(Role role, std::size_t index, const Pick& pick, double si_per_unit = 1.0);
  void learn_order();
  void take(const Wanted& wanted, const ifog_can_frame& frame, ifog_emit_sample emit, void* sink) noexcept;
  void set(const Entry& entry, std::uint64_t bits) noexcept;
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
  std::uint32_t beginning_axes_ = 0;  // any of which begins a sample
  std::uint32_t present_ = 0;         // axes of the sample being gathered
  std::uint32_t good_ = 0;            // of them, those with a value that can be
  bool counted_ = false;              // its counter is known
  std::uint32_t frames_ = 0;          // that brought axes of it
  // The last whole one, if it was counted. A counter that has never moved does not tell one sample from
  // another.
  struct Last {
    bool counted = false;
    std::uint32_t sequence = 0;
    std::array<double, IFOG_MAX_AXES> value{};
  } last_;
  bool counter_moved_ = false;
  ifog_sample sample_{};
  bool timed_ = false;   // its clock has been read
  bool beyond_ = false;  // since the last sample
  ifog_driver_counters counters_{};
};

}  // namespace ifog::dbc

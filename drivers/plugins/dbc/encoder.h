// SPDX-License-Identifier: Apache-2.0
// The inverse of the decoder: the frames a device described by the DBC file would have sent for a sample.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "drivers/plugins/dbc/picks.h"

namespace ifog::dbc {

class Encoder {
 public:
  explicit Encoder(const Picks& picks);

  // Emits the frames of one sample: those without an axis first (only when they bring a fresh environment
  // value), then the axes' in the order of their ids. Throws std::invalid_argument with one line: a value its
  // signal cannot hold.
  void encode(const ifog_sample& sample, ifog_emit_can emit, void* sink);

 private:
  enum class Role : std::uint8_t { kAxis, kCounter, kStatus, kTime, kEnvironment };
  struct Entry {
    Role role;
    std::size_t index;
    const Signal* signal;
  };
  // One frame: a message with a choice of its multiplexors' values.
  struct Layout {
    const Message* message = nullptr;
    std::vector<std::pair<const Signal*, std::uint64_t>> selection;
    std::vector<Entry> entries;
    bool carries_axis = false;
  };

  void add(Role role, std::size_t index, const Pick& pick);
  void put(const Layout& layout, const ifog_sample& sample, ifog_emit_can emit, void* sink) const;
  [[nodiscard]] std::uint64_t bits_of(const Entry& entry, const ifog_sample& sample) const;

  const Picks& picks_;
  std::vector<Layout> layouts_;
  std::uint32_t sent_ = 0;
};

}  // namespace ifog::dbc

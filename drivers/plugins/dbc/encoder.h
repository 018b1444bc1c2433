// SPDX-License-Identifier: Apache-2.0
// Encodes a sample as frames of a device described by a DBC file.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "drivers/plugins/dbc/picks.h"

namespace ifog::dbc {

class Encoder {
 public:
  explicit Encoder(const Picks& picks);

  // Emits the frames of one sample: first those without an axis (only with a fresh environment value), then
  // the axes' by id. Throws std::invalid_argument with one line for a value that its signal cannot hold.
  void encode(const ifog_sample& sample, ifog_emit_can emit, void* sink);

 private:
  struct Entry {
    Role role;
    std::size_t index;
    const Signal* signal;
  };
  // One frame: a message with certain multiplexor values.
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

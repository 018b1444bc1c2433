// SPDX-License-Identifier: Apache-2.0
#include "drivers/plugins/dbc/encoder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "drivers/dbc/codec.h"

namespace ifog::dbc {
namespace {

// Lengths of CAN FD frames above 8.
constexpr std::array<std::uint32_t, 7> kLongLengths{12, 16, 20, 24, 32, 48, 64};

std::uint8_t frame_length(std::uint32_t message_length) {
  if (message_length <= 8) return static_cast<std::uint8_t>(message_length);
  return static_cast<std::uint8_t>(*std::ranges::lower_bound(kLongLengths, message_length));
}

}  // namespace

Encoder::Encoder(const Picks& picks) : picks_(picks) {
  picks.each([&](Role role, std::size_t index, const Pick& pick) { add(role, index, pick); });
  std::ranges::stable_sort(layouts_, [](const Layout& a, const Layout& b) {
    if (a.carries_axis != b.carries_axis) return b.carries_axis;
    if (a.message->id != b.message->id) return a.message->id < b.message->id;
    return a.selection.size() == b.selection.size() && !a.selection.empty() &&
           a.selection.front().second < b.selection.front().second;
  });
}

void Encoder::add(Role role, std::size_t index, const Pick& pick) {
  std::vector<std::pair<const Signal*, std::uint64_t>> selection;
  for (const Signal* s = pick.signal; s->selector != kNone; s = &pick.message->signals[s->selector])
    selection.emplace_back(&pick.message->signals[s->selector], s->selected_by.front().first);
  const bool everywhere = selection.empty();
  bool placed = false;
  for (Layout& layout : layouts_) {
    if (layout.message != pick.message) continue;
    if (!everywhere && layout.selection != selection && !layout.selection.empty()) continue;
    // A frame without a multiplexor so far may use this selection.
    if (!everywhere) layout.selection = selection;
    layout.entries.push_back({role, index, pick.signal});
    layout.carries_axis = layout.carries_axis || role == Role::kAxis;
    placed = true;
    if (!everywhere) return;
  }
  if (placed) return;
  Layout layout;
  layout.message = pick.message;
  layout.selection = selection;
  // Signals that are in every frame of the message are in this one, too.
  for (const Layout& other : layouts_)
    if (other.message == pick.message && !everywhere) {
      for (const Entry& entry : other.entries)
        if (entry.signal->selector == kNone) layout.entries.push_back(entry);
      layout.carries_axis =
          std::ranges::any_of(layout.entries, [](const Entry& entry) { return entry.role == Role::kAxis; });
      break;
    }
  layout.entries.push_back({role, index, pick.signal});
  layout.carries_axis = layout.carries_axis || role == Role::kAxis;
  layouts_.push_back(std::move(layout));
}

std::uint64_t Encoder::bits_of(const Entry& entry, const ifog_sample& sample) const {
  switch (entry.role) {
    case Role::kAxis: {
      const double value = sample.value[entry.index] / picks_.axes[entry.index].si_per_unit;
      return raw_of(*entry.signal, picks_.axes[entry.index].sign != nullptr ? std::abs(value) : value);
    }
    case Role::kCounter:
      return sent_;
    case Role::kStatus:
      // A sample from elsewhere has no such status; the valid one is sent.
      if (picks_.status_good && sample.valid_axes != 0)
        return (sample.status & ~picks_.status_mask) | *picks_.status_good;
      return sample.status;
    case Role::kTime: {
      if ((sample.flags & IFOG_SAMPLE_DEVICE_TIME) == 0)
        throw std::invalid_argument("the time signal needs the device's time, and the sample has none");
      double units = static_cast<double>(sample.device_time_ns) * 1e-9 / picks_.seconds_per_unit;
      const Signal& s = *entry.signal;
      // An integer clock wraps like the device's.
      if (s.type == ValueType::kUnsigned) {
        const double range = std::ldexp(std::abs(s.scale), static_cast<int>(s.length));
        units -= range * std::floor((units - s.offset) / range);
        if (std::round((units - s.offset) / s.scale) >= std::ldexp(1.0, static_cast<int>(s.length)))
          units = s.offset;
      }
      return raw_of(s, units);
    }
    case Role::kEnvironment: {
      const UnitConversion& by = picks_.environments[entry.index].to_column;
      return raw_of(*entry.signal, (sample.environment[entry.index] - by.offset) / by.scale);
    }
  }
  return 0;
}

void Encoder::put(const Layout& layout, const ifog_sample& sample, ifog_emit_can emit, void* sink) const {
  ifog_can_frame frame{};
  frame.arrival_ns = sample.arrival_ns;
  frame.id = layout.message->id;
  frame.length = frame_length(layout.message->length);
  frame.flags = static_cast<std::uint8_t>((layout.message->extended ? unsigned{IFOG_CAN_EXTENDED} : 0U) |
                                          (frame.length > 8 ? unsigned{IFOG_CAN_FD} : 0U));
  const std::span<std::uint8_t> data(frame.data, frame.length);
  for (const auto& [selector, value] : layout.selection) set_raw_bits(*selector, value, data);
  for (const Entry& entry : layout.entries) {
    const bool integer = is_integer(entry.signal->type);
    // An integer cannot express "unknown"; the bits stay 0.
    if (entry.role == Role::kEnvironment && integer && std::isnan(sample.environment[entry.index])) continue;
    set_raw_bits(*entry.signal, bits_of(entry, sample), data);
    if (const Signal* sign = entry.role == Role::kAxis ? picks_.axes[entry.index].sign : nullptr)
      set_raw_bits(*sign, sample.value[entry.index] < 0.0 ? 1 : 0, data);
  }
  emit(sink, &frame);
}

void Encoder::encode(const ifog_sample& sample, ifog_emit_can emit, void* sink) {
  if (!picks_.counter.empty()) {
    if ((sample.flags & IFOG_SAMPLE_SEQUENCE) != 0) sent_ = sample.sequence;
    sent_ %= picks_.counter_modulus;
  }
  for (const Layout& layout : layouts_) {
    const bool fresh = std::ranges::any_of(layout.entries, [&](const Entry& entry) {
      return entry.role != Role::kEnvironment || (sample.environment_fresh & 1U << entry.index) != 0;
    });
    if (layout.carries_axis || fresh) put(layout, sample, emit, sink);
  }
  ++sent_;
}

}  // namespace ifog::dbc

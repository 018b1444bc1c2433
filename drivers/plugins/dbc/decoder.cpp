// SPDX-License-Identifier: Apache-2.0
#include "drivers/plugins/dbc/decoder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "drivers/dbc/codec.h"

namespace ifog::dbc {
namespace {

// NaN equals NaN, since a repeated frame has the same NaN.
bool same_value(double a, double b) noexcept { return a == b || (std::isnan(a) && std::isnan(b)); }

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

constexpr std::uint32_t bit(std::size_t i) { return 1U << i; }

// rad or rad/s
double value_of(const Axis& axis, std::span<const std::uint8_t> data) noexcept {
  const double value = physical(*axis.pick.signal, raw_bits(*axis.pick.signal, data)) * axis.si_per_unit;
  return axis.sign != nullptr && raw_bits(*axis.sign, data) != 0 ? -value : value;
}

// A float may be out of range for int64 in ns.
std::optional<std::int64_t> nanoseconds(double seconds) {
  constexpr double kMost = 9e9, kNsPerSecond = 1e9;
  if (!(std::abs(seconds) < kMost)) return {};
  return std::llround(seconds * kNsPerSecond);
}

}  // namespace

Decoder::Decoder(const Picks& picks) : picks_(picks) {
  picks.each([&](Role role, std::size_t index, const Pick& pick) { add(role, index, pick); });
  if (const Signal* const s = picks.time ? picks.time->signal : nullptr; s != nullptr && is_integer(s->type))
    sample_.device_wrap_ns =
        nanoseconds(std::ldexp(std::abs(s->scale), static_cast<int>(s->length)) * picks.seconds_per_unit)
            .value_or(0);
  learn_order();
  std::fill(std::begin(sample_.environment), std::end(sample_.environment), kMissing);
}

void Decoder::add(Role role, std::size_t index, const Pick& pick) {
  auto at = std::ranges::find_if(wanted_, [&](const Wanted& w) {
    return w.id == pick.message->id && w.extended == pick.message->extended;
  });
  if (at == wanted_.end()) at = wanted_.insert(at, {pick.message->id, pick.message->extended, {}});
  std::size_t bytes = bytes_needed(*pick.signal);
  if (const Signal* sign = role == Role::kAxis ? picks_.axes[index].sign : nullptr)
    bytes = std::max(bytes, bytes_needed(*sign));
  at->entries.push_back({role, index, pick.message, pick.signal, bytes});
}

void Decoder::learn_order() {
  all_axes_ = bit(picks_.axes.size()) - 1;
  const auto carries_counter = [&](const Axis& axis) {
    return std::ranges::any_of(picks_.counter, [&](const Pick& counter) {
      return counter.message == axis.pick.message && counter.signal->selector == kNone;
    });
  };
  if (std::ranges::all_of(picks_.axes, carries_counter)) {
    beginning_axes_ = all_axes_;  // any axis may begin: the counter decides
    return;
  }
  // By id, then by multiplexor value: the order in which a device sends.
  const auto order = [](const Axis& axis) {
    const Signal& s = *axis.pick.signal;
    return std::pair(axis.pick.message->id,
                     s.selected_by.empty() ? std::uint64_t{0} : s.selected_by.front().first);
  };
  auto first = order(picks_.axes.front());
  for (const Axis& axis : picks_.axes) first = std::min(first, order(axis));
  for (std::size_t i = 0; i < picks_.axes.size(); ++i)
    if (order(picks_.axes[i]) == first) beginning_axes_ |= bit(i);
}

// A mean of logarithms, so that neither a silence nor lost frames decide.
void Decoder::learn_pause(std::uint32_t brings, std::int64_t arrival_ns) noexcept {
  constexpr double kMemory = 256.0;  // samples
  const std::int64_t before_ns = std::exchange(pauses_.arrived_ns, arrival_ns);
  if (beginning_axes_ == all_axes_ || before_ns < 0 || arrival_ns == 0) return;
  const double pause =
      std::log2(std::clamp(static_cast<double>(arrival_ns - before_ns), 1e3, 1e9));  // a log has 1 us
  for (std::size_t i = 0; i < pauses_.mean.size(); ++i)
    if ((brings & bit(i)) != 0) {
      pauses_.count[i] = std::min(pauses_.count[i] + 1.0, kMemory);
      pauses_.mean[i] += (pause - pauses_.mean[i]) / pauses_.count[i];
    }
  const auto here = static_cast<std::size_t>(std::countr_zero(brings));
  const auto assumed = static_cast<std::size_t>(std::countr_zero(beginning_axes_));
  if (pauses_.count[assumed] == 0.0 || pauses_.mean[here] <= pauses_.mean[assumed] + 1.0) return;
  give_up();
  beginning_axes_ = brings;
}

void Decoder::begin_sample() noexcept {
  present_ = 0;
  good_ = 0;
  counted_ = false;
  frames_ = 0;
}

// True if an incomplete sample may be a late copy of the previous one.
bool Decoder::repeats_last() const noexcept {
  if (!last_.counted || !counted_ || !counter_moved_ || sample_.sequence != last_.sequence) return false;
  for (std::size_t i = 0; i < last_.value.size(); ++i)
    if ((present_ & bit(i)) != 0 && !same_value(sample_.value[i], last_.value[i])) return false;
  return true;
}

void Decoder::give_up() noexcept {
  if (present_ != 0 && repeats_last())
    counters_.frames_repeated += frames_;
  else if (present_ != 0)
    ++counters_.samples_incomplete;
  begin_sample();
}

void Decoder::reset() noexcept {
  give_up();
  pauses_.arrived_ns = -1;
  last_.counted = false;
  sample_.environment_fresh = 0;
  timed_ = false;
}

void Decoder::decode(const ifog_can_frame& frame, ifog_emit_sample emit, void* sink) noexcept {
  const bool extended = (frame.flags & IFOG_CAN_EXTENDED) != 0;
  for (const Wanted& wanted : wanted_)
    if (wanted.id == frame.id && wanted.extended == extended) {
      take(wanted, frame, emit, sink);
      return;
    }
  ++counters_.frames_other;
}

void Decoder::take(const Wanted& wanted, const ifog_can_frame& frame, ifog_emit_sample emit,
                   void* sink) noexcept {
  const std::span<const std::uint8_t> data(frame.data,
                                           std::min<std::size_t>(frame.length, sizeof frame.data));
  std::uint32_t brings = 0;
  const Entry* counter = nullptr;
  for (const Entry& entry : wanted.entries) {
    if (!selected(*entry.message, *entry.signal, data)) continue;
    if (entry.bytes > data.size()) {
      ++counters_.frames_format;
      return;
    }
    if (entry.role == Role::kAxis) brings |= bit(entry.index);
    if (entry.role == Role::kCounter) counter = &entry;
  }
  if (brings != 0) {
    const std::uint32_t count =
        counter == nullptr
            ? 0
            : static_cast<std::uint32_t>(raw_bits(*counter->signal, data) % picks_.counter_modulus);
    const bool same_count = counter != nullptr && counted_ && count == sample_.sequence;
    const bool in_last = counter != nullptr && last_.counted && count == last_.sequence;
    if (present_ != 0 && counted_ && counter_moved_ &&
        (same_count ? (present_ & brings) == brings && repeats(wanted, data, sample_.value)
                    : in_last && repeats(wanted, data, last_.value.data()))) {
      ++counters_.frames_good;
      ++counters_.frames_repeated;
      return;
    }
    learn_pause(brings, frame.arrival_ns);
    const bool other_count = counter != nullptr && counted_ && !same_count;
    if (present_ != 0 && (other_count || (present_ & brings) != 0)) give_up();
    if (present_ == 0 && (brings & beginning_axes_) == 0) {
      ++counters_.frames_good;
      ++counters_.samples_incomplete;
      return;
    }
  }
  for (const Entry& entry : wanted.entries)
    if (selected(*entry.message, *entry.signal, data) && (entry.role != Role::kCounter || brings != 0))
      set(entry, data);
  ++counters_.frames_good;
  if (brings != 0) ++frames_;
  if (brings != 0 && present_ == all_axes_) complete(frame.arrival_ns, emit, sink);
}

// True if the frame's axes have the same values as before.
bool Decoder::repeats(const Wanted& wanted, std::span<const std::uint8_t> data,
                      const double* known) const noexcept {
  for (const Entry& entry : wanted.entries) {
    if (entry.role != Role::kAxis || !selected(*entry.message, *entry.signal, data)) continue;
    if (!same_value(value_of(picks_.axes[entry.index], data), known[entry.index])) return false;
  }
  return true;
}

void Decoder::set(const Entry& entry, std::span<const std::uint8_t> data) noexcept {
  const std::uint64_t bits = raw_bits(*entry.signal, data);
  switch (entry.role) {
    case Role::kCounter:
      sample_.sequence = static_cast<std::uint32_t>(bits % picks_.counter_modulus);
      counted_ = true;
      break;
    case Role::kAxis: {
      const double value = value_of(picks_.axes[entry.index], data);
      sample_.value[entry.index] = value;
      if (std::isfinite(value)) good_ |= bit(entry.index);
      judge(*entry.signal, physical(*entry.signal, bits));
      present_ |= bit(entry.index);
      break;
    }
    case Role::kStatus:
      sample_.status = static_cast<std::uint32_t>(bits);
      break;
    case Role::kTime: {
      const double seconds = physical(*entry.signal, bits) * picks_.seconds_per_unit;
      if (const std::optional<std::int64_t> ns = nanoseconds(seconds)) {
        sample_.device_time_ns = *ns;
        timed_ = true;
      }
      break;
    }
    case Role::kEnvironment: {
      const double value = physical(*entry.signal, bits);
      if (!std::isfinite(value)) break;
      judge(*entry.signal, value);
      const UnitConversion& by = picks_.environments[entry.index].to_column;
      sample_.environment[entry.index] = value * by.scale + by.offset;
      sample_.environment_fresh |= bit(entry.index);
      break;
    }
  }
}

// Ranges in real files are often wrong, especially of signed signals, so values beyond are kept and reported.
void Decoder::judge(const Signal& signal, double value) noexcept {
  if (!has_range(signal) || !std::isfinite(value) || in_range(signal, value)) return;
  beyond_ = true;
  if (++counters_.values_beyond != 1) return;
  const std::string& name = display_name(signal);
  std::copy_n(name.data(), std::min(name.size(), sizeof counters_.beyond_name - 1), counters_.beyond_name);
  counters_.beyond_value = value;
  counters_.beyond_minimum = signal.minimum;
  counters_.beyond_maximum = signal.maximum;
}

void Decoder::complete(std::int64_t arrival_ns, ifog_emit_sample emit, void* sink) noexcept {
  sample_.arrival_ns = arrival_ns;
  sample_.flags = 0;
  if (counted_) sample_.flags |= IFOG_SAMPLE_SEQUENCE;
  if (timed_) sample_.flags |= IFOG_SAMPLE_DEVICE_TIME;
  if (std::exchange(beyond_, false)) sample_.flags |= IFOG_SAMPLE_BEYOND;
  const bool good = !picks_.status_good || (sample_.status & picks_.status_mask) == *picks_.status_good;
  sample_.valid_axes = good ? good_ : 0;
  emit(sink, &sample_);
  counter_moved_ = counter_moved_ || (counted_ && last_.counted && sample_.sequence != last_.sequence);
  last_.counted = counted_;
  last_.sequence = sample_.sequence;
  std::copy_n(std::begin(sample_.value), last_.value.size(), last_.value.begin());
  begin_sample();
  sample_.environment_fresh = 0;
}

}  // namespace ifog::dbc

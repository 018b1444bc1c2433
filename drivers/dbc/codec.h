// SPDX-License-Identifier: Apache-2.0
// A signal's value from a frame's bytes, and into them. No allocation; frames of up to 64 bytes.
//
// The signal must have passed check_fits, and the data hold at least bytes_needed(signal).
#pragma once

#include <cstdint>
#include <span>

#include "drivers/dbc/database.h"

namespace ifog::dbc {

// How many bytes of the frame reading the signal touches.
std::size_t bytes_needed(const Signal& signal) noexcept;

// The bits of the signal, right-aligned, without sign extension.
std::uint64_t raw_bits(const Signal& signal, std::span<const std::uint8_t> data) noexcept;
void set_raw_bits(const Signal& signal, std::uint64_t bits, std::span<std::uint8_t> data) noexcept;

// raw · scale + offset, with the sign, or as IEEE half, float or double.
double physical(const Signal& signal, std::uint64_t bits) noexcept;

// The nearest raw value. Throws std::invalid_argument: NaN in an integer, out of the signal's range.
std::uint64_t raw_of(const Signal& signal, double value);

// Whether a frame of these bytes carries the signal: its multiplexors, one depending on the other, select it.
// False too if a multiplexor lies beyond the data.
bool selected(const Message& message, const Signal& signal, std::span<const std::uint8_t> data) noexcept;

}  // namespace ifog::dbc

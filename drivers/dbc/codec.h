// SPDX-License-Identifier: Apache-2.0
// Reads and writes a signal in a frame's bytes. No allocation; frames of up to 64 bytes. The signal must have
// passed check_fits(), and the data must have at least bytes_needed(signal) bytes.
#pragma once

#include <cstdint>
#include <span>

#include "drivers/dbc/database.h"

namespace ifog::dbc {

// Number of bytes of the frame needed for the signal.
std::size_t bytes_needed(const Signal& signal) noexcept;

// Bits of the signal, right-aligned, without sign extension.
std::uint64_t raw_bits(const Signal& signal, std::span<const std::uint8_t> data) noexcept;
void set_raw_bits(const Signal& signal, std::uint64_t bits, std::span<std::uint8_t> data) noexcept;

// raw · scale + offset; raw is signed, unsigned, or an IEEE float or double.
double physical(const Signal& signal, std::uint64_t bits) noexcept;

// Nearest raw value. Throws std::invalid_argument for NaN in an integer, or out of the signal's range.
std::uint64_t raw_of(const Signal& signal, double value);

// True if the multiplexors in the frame select the signal. False if a multiplexor is beyond the data.
bool selected(const Message& message, const Signal& signal, std::span<const std::uint8_t> data) noexcept;

}  // namespace ifog::dbc

// SPDX-License-Identifier: Apache-2.0
#include "drivers/dbc/codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "drivers/ifog/quoted.h"

namespace ifog::dbc {
namespace {

constexpr std::uint64_t low_bits(std::uint32_t n) {
  return n >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1;
}

// Calls visit(byte, shift in the byte, bits, shift in the value) for the signal's part in each byte, from the
// least significant bits on.
template <typename Visit>
void pieces(const Signal& signal, Visit&& visit) noexcept {
  std::uint32_t done = 0;
  if (signal.order == ByteOrder::kLittle) {
    for (std::uint32_t bit = signal.start_bit; done < signal.length;) {
      const std::uint32_t in_byte = bit % 8;
      const std::uint32_t n = std::min(8 - in_byte, signal.length - done);
      visit(bit / 8, in_byte, n, done);
      done += n;
      bit += n;
    }
    return;
  }
  // Big-endian: bit positions counted from the frame's first, most significant bit are contiguous.
  const std::uint32_t first = signal.start_bit / 8 * 8 + (7 - signal.start_bit % 8);
  std::uint32_t end = first + signal.length;  // after the least significant bit
  while (done < signal.length) {
    const std::uint32_t byte = (end - 1) / 8;
    const std::uint32_t in_byte = byte * 8 + 8 - end;
    const std::uint32_t n = std::min(8 - in_byte, signal.length - done);
    visit(byte, in_byte, n, done);
    done += n;
    end -= n;
  }
}

}  // namespace

std::size_t bytes_needed(const Signal& signal) noexcept {
  std::size_t needed = 0;
  pieces(signal, [&](std::uint32_t byte, std::uint32_t, std::uint32_t, std::uint32_t) {
    needed = std::max<std::size_t>(needed, byte + 1);
  });
  return needed;
}

std::uint64_t raw_bits(const Signal& signal, std::span<const std::uint8_t> data) noexcept {
  std::uint64_t bits = 0;
  pieces(signal, [&](std::uint32_t byte, std::uint32_t in_byte, std::uint32_t n, std::uint32_t done) {
    bits |= (static_cast<std::uint64_t>(data[byte]) >> in_byte & low_bits(n)) << done;
  });
  return bits;
}

void set_raw_bits(const Signal& signal, std::uint64_t bits, std::span<std::uint8_t> data) noexcept {
  pieces(signal, [&](std::uint32_t byte, std::uint32_t in_byte, std::uint32_t n, std::uint32_t done) {
    const std::uint64_t kept = data[byte] & ~(low_bits(n) << in_byte);
    data[byte] = static_cast<std::uint8_t>(kept | (bits >> done & low_bits(n)) << in_byte);
  });
}

double physical(const Signal& signal, std::uint64_t bits) noexcept {
  double raw = 0.0;
  switch (signal.type) {
    case ValueType::kUnsigned:
      raw = static_cast<double>(bits);
      break;
    case ValueType::kSigned: {
      const std::uint64_t sign = std::uint64_t{1} << (signal.length - 1);
      // Sign extension in two's complement.
      raw = static_cast<double>(static_cast<std::int64_t>((bits ^ sign) - sign));
      break;
    }
    case ValueType::kFloat:
      raw = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
      break;
    case ValueType::kDouble:
      raw = std::bit_cast<double>(bits);
      break;
  }
  return raw * signal.scale + signal.offset;
}

std::uint64_t raw_of(const Signal& signal, double value) {
  const double raw = (value - signal.offset) / signal.scale;
  if (signal.type == ValueType::kDouble) return std::bit_cast<std::uint64_t>(raw);
  const auto refuse = [&](const char* expected) {
    throw std::invalid_argument("signal " + printable(signal.name) + " cannot hold " + std::to_string(value) +
                                ", expected " + expected);
  };
  if (signal.type == ValueType::kFloat) {
    const auto narrow = static_cast<float>(raw);
    if (std::isfinite(raw) && !std::isfinite(narrow)) refuse("what a 32-bit float holds");
    return std::bit_cast<std::uint32_t>(narrow);
  }
  const double rounded = std::round(raw);
  const bool is_signed = signal.type == ValueType::kSigned;
  // Powers of two are exact in a double, and the comparison avoids an undefined conversion.
  const double below = is_signed ? -std::ldexp(1.0, static_cast<int>(signal.length) - 1) : 0.0;
  const double above = std::ldexp(1.0, static_cast<int>(signal.length) - (is_signed ? 1 : 0));
  if (!(rounded >= below && rounded < above))
    refuse(("a value from " + std::to_string(below * signal.scale + signal.offset) + " to " +
            std::to_string((above - 1.0) * signal.scale + signal.offset))
               .c_str());
  return (is_signed ? static_cast<std::uint64_t>(static_cast<std::int64_t>(rounded))
                    : static_cast<std::uint64_t>(rounded)) &
         low_bits(signal.length);
}

bool selected(const Message& message, const Signal& signal, std::span<const std::uint8_t> data) noexcept {
  const Signal* asked = &signal;
  while (asked->selector != kNone) {
    const Signal& selector = message.signals[asked->selector];
    if (bytes_needed(selector) > data.size()) return false;
    const std::uint64_t value = raw_bits(selector, data);
    bool inside = false;
    for (const auto& [from, to] : asked->selected_by) inside = inside || (from <= value && value <= to);
    if (!inside) return false;
    asked = &selector;
  }
  return true;
}

}  // namespace ifog::dbc

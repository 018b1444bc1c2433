// SPDX-License-Identifier: Apache-2.0
// What a Vector DBC file says about the frames on a CAN bus: messages and where their signals lie.
//
// Read are BO_, SG_ (multiplexing included), SIG_VALTYPE_, SG_MUL_VAL_ and, of the attributes (BA_), the long
// names SystemMessageLongSymbol and SystemSignalLongSymbol. The other sections (nodes, comments, value
// tables, …) carry nothing that decoding needs and are skipped.
//
// Real files hold slips, most of them in parts that nobody reads. So a line that cannot be read is a warning
// and takes along only what stands on it; a signal that such a line makes doubtful stays in the list, marked,
// and whoever picks it is told the line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"

namespace ifog::dbc {

enum class ByteOrder : std::uint8_t {
  kLittle,  // "@1", Intel: start_bit is the least significant bit; later bits are in the same or higher bytes
  kBig  // "@0", Motorola: start_bit is the most significant bit; later bits are below it, then in the next
        // byte
};

// kHalf, kFloat, kDouble: IEEE 754 of 16, 32, 64 bits. SIG_VALTYPE_ knows the types 1 (float) and 2 (double)
// only; a float of 16 bits is a half, as other readers take it.
enum class ValueType : std::uint8_t { kUnsigned, kSigned, kHalf, kFloat, kDouble };

inline constexpr bool is_integer(ValueType type) {
  return type == ValueType::kUnsigned || type == ValueType::kSigned;
}

inline constexpr std::size_t kNone = static_cast<std::size_t>(-1);

struct Signal {
  std::string name;
  std::string long_name;  // SystemSignalLongSymbol: names of more than 32 characters; "" where there is none
  std::string refused;    // why it must not be used: FILE:LINE: what; "" where it may
  std::size_t line = 0;   // in the file, for messages to people
  std::uint32_t start_bit = 0;  // byte × 8 + bit in the byte, 0 the least significant
  std::uint32_t length = 0;     // bits, 1 … 64
  ByteOrder order = ByteOrder::kLittle;
  ValueType type = ValueType::kUnsigned;
  double scale = 1.0;  // physical = raw · scale + offset
  double offset = 0.0;
  double minimum = 0.0;  // physical; where it is not below maximum ("[0|0]"), the file states no range
  double maximum = 0.0;
  std::string unit;
  bool selects =
      false;  // a multiplexor: its raw value says which of the message's multiplexed signals are there
  bool selected = false;  // there in some frames only: marked m, or named by SG_MUL_VAL_
  std::size_t selector =
      kNone;  // index in the message of the multiplexor this signal depends on; kNone: always there
  std::vector<std::pair<std::uint64_t, std::uint64_t>>
      selected_by;  // its raw values, from-to, that select this one
};

inline bool has_range(const Signal& signal) { return signal.minimum < signal.maximum; }
// False for NaN.
inline bool in_range(const Signal& signal, double value) {
  return has_range(signal) ? value >= signal.minimum && value <= signal.maximum : value == value;
}

struct Message {
  std::string name;       // "" where the line that begins it could not be read so far
  std::string long_name;  // SystemMessageLongSymbol
  std::string refused;    // why none of its signals may be used
  std::size_t line = 0;
  std::uint32_t id = 0;  // 11 or 29 bits, without the flag bit
  bool extended = false;
  std::uint32_t length = 0;  // bytes
  std::vector<Signal> signals;
};

struct Database {
  std::string file;
  std::vector<Message> messages;
  std::vector<std::string> warnings;  // one a bad line, FILE:LINE: what is there, what was expected
};

// Throws std::runtime_error with one such line when the file has no message that can be read, or
// kMostBadLines.
Database parse_database(std::string_view text, const std::string& file);
inline constexpr std::size_t kMostBadLines = 1000;

// Addresses inside a database.
struct SignalInMessage {
  const Message* message = nullptr;
  const Signal* signal = nullptr;
};

// All signals called "SIGNAL" or "MESSAGE.SIGNAL", each name the short or the long one; refused ones too.
std::vector<SignalInMessage> find_signals(const Database& database, std::string_view name);

// The long name where there is one.
const std::string& display_name(const Message& message);
const std::string& display_name(const Signal& signal);

// Throws std::runtime_error: file, line, the signal and why it cannot be read from its message, which may be
// a bad line of the file.
void check_fits(const Database& database, const Message& message, const Signal& signal);

inline const std::string& display_name(const Message& message) {
  return message.long_name.empty() ? message.name : message.long_name;
}

inline const std::string& display_name(const Signal& signal) {
  return signal.long_name.empty() ? signal.name : signal.long_name;
}

inline std::vector<SignalInMessage> find_signals(const Database& database, std::string_view name) {
  const std::size_t dot = name.find('.');
  const std::string_view message = dot == std::string_view::npos ? std::string_view() : name.substr(0, dot);
  const std::string_view signal = dot == std::string_view::npos ? name : name.substr(dot + 1);
  std::vector<SignalInMessage> found;
  for (const Message& m : database.messages) {
    if (dot != std::string_view::npos && m.name != message && m.long_name != message) continue;
    for (const Signal& s : m.signals)
      if (s.name == signal || s.long_name == signal) found.push_back({&m, &s});
  }
  return found;
}

inline void check_fits(const Database& database, const Message& message, const Signal& signal) {
  if (!message.refused.empty()) throw std::runtime_error(message.refused);
  if (!signal.refused.empty()) throw std::runtime_error(signal.refused);
  const auto refuse = [&](const std::string& why) {
    throw std::runtime_error(database.file + ":" + std::to_string(signal.line) + ": signal " +
                             printable(message.name + "." + signal.name) + " " + why);
  };
  constexpr std::uint32_t kLongestFrame = 64;
  if (message.length > kLongestFrame)
    refuse("is in a message of " + std::to_string(message.length) + " bytes, expected at most 64 (CAN FD)");
  // Counted from the first bit of the frame in the order in which the signal runs through it.
  const std::uint32_t first = signal.order == ByteOrder::kLittle
                                  ? signal.start_bit
                                  : signal.start_bit / 8 * 8 + (7 - signal.start_bit % 8);
  if (first + signal.length > message.length * 8)
    refuse("reaches beyond the " + std::to_string(message.length) + " bytes of its message");
  if (signal.scale == 0.0) refuse("has factor 0, expected any other number");
  // Each is asked of every frame; one that depends on itself would be asked for ever.
  std::size_t depth = 0;
  for (std::size_t k = signal.selector; k != kNone; k = message.signals[k].selector) {
    const Signal& selector = message.signals[k];
    if (!selector.refused.empty())
      refuse("depends on multiplexor " + printable(selector.name) + ", and " + selector.refused);
    if (++depth > message.signals.size()) refuse("depends on multiplexors in a circle");
    if (depth > kInputLimits.multiplexors)
      refuse("depends on more than " + std::to_string(kInputLimits.multiplexors) +
             " multiplexors one behind the other");
  }
}

}  // namespace ifog::dbc

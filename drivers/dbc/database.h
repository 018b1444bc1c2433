// SPDX-License-Identifier: Apache-2.0
// What a Vector DBC file says about the frames on a CAN bus: messages and where their signals lie.
//
// Read are BO_, SG_ (multiplexing included), SIG_VALTYPE_, SG_MUL_VAL_ and, of the attributes (BA_), the long
// names SystemMessageLongSymbol and SystemSignalLongSymbol. The other sections (nodes, comments, value
// tables, …) carry nothing that decoding needs and are skipped.
//
// Real files hold slips, most of them in parts that nobody reads. So a line that cannot be read is a warning
// and takes along only what stands on it; a signal that such a line makes doubtful stays in the list, marked,
// and whoever picks it gets the line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

}  // namespace ifog::dbc

// SPDX-License-Identifier: Apache-2.0
// Messages and signals of a Vector DBC file.
//
// Parsed are BO_, SG_ (including multiplexing), SIG_VALTYPE_, SG_MUL_VAL_ and the long-name attributes (BA_)
// SystemMessageLongSymbol and SystemSignalLongSymbol. Other sections are not needed for decoding and are
// skipped.
//
// Real files contain errors, mostly in unused parts. An invalid line is a warning and only affects its own
// content. Signals that it makes doubtful are marked with the error, which is reported when they are used.
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

// kFloat, kDouble: IEEE 754 of 32 and 64 bits.
enum class ValueType : std::uint8_t { kUnsigned, kSigned, kFloat, kDouble };

inline constexpr bool is_integer(ValueType type) {
  return type == ValueType::kUnsigned || type == ValueType::kSigned;
}

inline constexpr std::size_t kNone = static_cast<std::size_t>(-1);

struct Signal {
  std::string name;
  std::string long_name;        // SystemSignalLongSymbol, for names above 32 characters; else ""
  std::string refused;          // why it must not be used: FILE:LINE: error; "" if it is valid
  std::size_t line = 0;         // in the file, for messages
  std::uint32_t start_bit = 0;  // byte × 8 + bit in the byte, 0 the least significant
  std::uint32_t length = 0;     // bits, 1 … 64
  ByteOrder order = ByteOrder::kLittle;
  ValueType type = ValueType::kUnsigned;
  double scale = 1.0;  // physical = raw · scale + offset
  double offset = 0.0;
  double minimum = 0.0;  // physical; if not below maximum ("[0|0]") the file states no range
  double maximum = 0.0;
  std::string unit;
  bool selects = false;   // a multiplexor: its raw value selects the message's multiplexed signals
  bool selected = false;  // present in some frames only: marked m, or named by SG_MUL_VAL_
  std::size_t selector =
      kNone;  // index in the message of the multiplexor that selects this signal; kNone: always present
  std::vector<std::pair<std::uint64_t, std::uint64_t>>
      selected_by;  // ranges of the multiplexor's raw values that select this one
};

inline bool has_range(const Signal& signal) { return signal.minimum < signal.maximum; }
// False for NaN.
inline bool in_range(const Signal& signal, double value) {
  return has_range(signal) ? value >= signal.minimum && value <= signal.maximum : value == value;
}

struct Message {
  std::string name;       // "" if its line could not be parsed
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
  std::vector<std::string> warnings;  // one per invalid line, FILE:LINE: what is there, what was expected
};

// Throws std::runtime_error with one such line if no message is valid, or at kMostBadLines.
Database parse_database(std::string_view text, const std::string& file);
inline constexpr std::size_t kMostBadLines = 1000;

// Pointers into a database.
struct SignalInMessage {
  const Message* message = nullptr;
  const Signal* signal = nullptr;
};

// All signals named "SIGNAL" or "MESSAGE.SIGNAL", with short or long names, including refused ones.
std::vector<SignalInMessage> find_signals(const Database& database, std::string_view name);

// Long name, or the short one if there is none.
const std::string& display_name(const Message& message);
const std::string& display_name(const Signal& signal);

// Throws std::runtime_error if the signal cannot be read from its message: file, line, signal and reason.
void check_fits(const Database& database, const Message& message, const Signal& signal);

}  // namespace ifog::dbc

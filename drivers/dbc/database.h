// What a Vector DBC file says about the frames on a CAN bus: messages and where their signals lie.
//
// Read are BO_, SG_ (multiplexing included), SIG_VALTYPE_ and SG_MUL_VAL_. The other sections (nodes,
// comments, attributes, value tables, …) carry nothing that decoding needs and are skipped.
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

enum class ValueType : std::uint8_t { kUnsigned, kSigned, kFloat, kDouble };

inline constexpr std::size_t kNone = static_cast<std::size_t>(-1);

struct Signal {
  std::string name;
  std::size_t line = 0;         // in the file, for messages to people
  std::uint32_t start_bit = 0;  // byte × 8 + bit in the byte, 0 the least significant
  std::uint32_t length = 0;     // bits, 1 … 64
  ByteOrder order = ByteOrder::kLittle;
  ValueType type = ValueType::kUnsigned;
  double scale = 1.0;  // physical = raw · scale + offset
  double offset = 0.0;
  std::string unit;
  bool selects =
      false;  // a multiplexor: its raw value says which of the message's multiplexed signals are there
  std::size_t selector =
      kNone;  // index in the message of the multiplexor this signal depends on; kNone: always there
  std::vector<std::pair<std::uint64_t, std::uint64_t>>
      selected_by;  // its raw values, from-to, that select this one
};

struct Message {
  std::string name;
  std::size_t line = 0;
  std::uint32_t id = 0;  // 11 or 29 bits, without the flag bit
  bool extended = false;
  std::uint32_t length = 0;  // bytes
  std::vector<Signal> signals;
};

struct Database {
  std::string file;
  std::vector<Message> messages;
};

// Throws std::runtime_error with one line: file, line, what is there, what was expected.
// Whether a signal fits its message is checked where the signal is used (`check_fits`), so that a slip in a
// part of the file that nobody reads does no harm.
Database parse_database(std::string_view text, const std::string& file);

// Throws std::runtime_error: file, line, the signal and why it cannot be read from its message.
void check_fits(const Database& database, const Message& message, const Signal& signal);

}  // namespace ifog::dbc

// SPDX-License-Identifier: Apache-2.0
#include "drivers/dbc/database.h"

#include <stdexcept>

#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"

namespace ifog::dbc {

const std::string& display_name(const Message& message) {
  return message.long_name.empty() ? message.name : message.long_name;
}

const std::string& display_name(const Signal& signal) {
  return signal.long_name.empty() ? signal.name : signal.long_name;
}

std::vector<SignalInMessage> find_signals(const Database& database, std::string_view name) {
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

void check_fits(const Database& database, const Message& message, const Signal& signal) {
  if (!message.refused.empty()) throw std::runtime_error(message.refused);
  if (!signal.refused.empty()) throw std::runtime_error(signal.refused);
  const auto refuse = [&](const std::string& why) {
    throw std::runtime_error(database.file + ":" + std::to_string(signal.line) + ": signal " +
                             printable(message.name + "." + signal.name) + " " + why);
  };
  constexpr std::uint32_t kLongestFrame = 64;
  if (message.length > kLongestFrame)
    refuse("is in a message of " + std::to_string(message.length) + " bytes, expected at most 64 (CAN FD)");
  // Counted from the first bit of the frame in the signal's bit order.
  const std::uint32_t first = signal.order == ByteOrder::kLittle
                                  ? signal.start_bit
                                  : signal.start_bit / 8 * 8 + (7 - signal.start_bit % 8);
  if (first + signal.length > message.length * 8)
    refuse("reaches beyond the " + std::to_string(message.length) + " bytes of its message");
  if (signal.scale == 0.0) refuse("has factor 0, expected any other number");
  // Detects a multiplexor that depends on itself.
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

#include "drivers/capture/candump.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "drivers/capture/text_file.h"

namespace ifog {
namespace {

constexpr std::uint32_t kExtendedFlag = 0x80000000U,
                        kErrorFlag = 0x20000000U;  // linux/can.h, as candump prints them
constexpr std::size_t kClassicBytes = 8, kFdBytes = 64;

// Reads a line from its left, a token at a time.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : rest_(text) {}

  bool literal(char c) {
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  // Blanks, at least one.
  bool blanks() {
    const std::size_t before = rest_.size();
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t')) rest_.remove_prefix(1);
    return rest_.size() < before;
  }
  std::string_view word() {
    const std::size_t end = std::min(rest_.find_first_of(" \t"), rest_.size());
    const std::string_view found = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return found;
  }
  // Decimal digits, as many as there are; false for none or an overflow.
  bool decimal(std::uint64_t& value, std::size_t& digits) {
    value = 0;
    digits = 0;
    while (!rest_.empty() && rest_.front() >= '0' && rest_.front() <= '9') {
      if (value > (std::numeric_limits<std::int64_t>::max() - 9) / 10) return false;
      value = value * 10 + static_cast<std::uint64_t>(rest_.front() - '0');
      rest_.remove_prefix(1);
      ++digits;
    }
    return digits > 0;
  }
  bool hex(std::uint32_t& digit) {
    if (rest_.empty()) return false;
    const char c = rest_.front();
    if (c >= '0' && c <= '9')
      digit = static_cast<std::uint32_t>(c - '0');
    else if (c >= 'A' && c <= 'F')
      digit = static_cast<std::uint32_t>(c - 'A' + 10);
    else if (c >= 'a' && c <= 'f')
      digit = static_cast<std::uint32_t>(c - 'a' + 10);
    else
      return false;
    rest_.remove_prefix(1);
    return true;
  }
  [[nodiscard]] bool at(char c) const { return !rest_.empty() && rest_.front() == c; }
  [[nodiscard]] bool done() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

bool parse_time(Cursor& in, std::int64_t& time_ns) {
  std::uint64_t seconds = 0, fraction = 0;
  std::size_t digits = 0;
  constexpr std::uint64_t kMostSeconds = 9'000'000'000;  // what an int64 of nanoseconds holds
  if (!in.literal('(') || !in.decimal(seconds, digits) || seconds > kMostSeconds) return false;
  if (!in.literal('.') || !in.decimal(fraction, digits) || digits > 9 || !in.literal(')')) return false;
  for (; digits < 9; ++digits) fraction *= 10;
  time_ns = static_cast<std::int64_t>(seconds * 1'000'000'000 + fraction);
  return true;
}

bool parse_data(Cursor& in, std::size_t most, ifog_can_frame& frame) {
  std::size_t n = 0;
  std::uint32_t high = 0, low = 0;
  while (in.hex(high)) {
    if (n == most || !in.hex(low)) return false;
    frame.data[n++] = static_cast<std::uint8_t>(high << 4U | low);
    in.literal('.');  // cansend's notation
  }
  frame.length = static_cast<std::uint8_t>(n);
  return true;
}

}  // namespace

CandumpLine parse_candump_line(std::string_view line, CandumpEntry& entry) noexcept {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t'))
    line.remove_suffix(1);
  if (line.empty() || line.front() == '#') return CandumpLine::blank;

  ifog_can_frame& frame = entry.frame;
  frame = ifog_can_frame{};
  Cursor in(line);
  if (!parse_time(in, frame.arrival_ns) || !in.blanks()) return CandumpLine::malformed;
  entry.interface = in.word();
  if (entry.interface.empty() || !in.blanks()) return CandumpLine::malformed;

  std::uint32_t id = 0, digit = 0;
  std::size_t digits = 0;
  for (; digits < 8 && in.hex(digit); ++digits) id = id << 4U | digit;
  if ((digits != 3 && digits != 8) || !in.literal('#')) return CandumpLine::malformed;
  const bool error = digits == 8 && (id & kErrorFlag) != 0;
  if (digits == 3 ? id > 0x7FFU : (id & ~(kErrorFlag | kExtendedFlag)) > 0x1FFFFFFFU)
    return CandumpLine::malformed;
  frame.id = id & 0x1FFFFFFFU;
  if (digits == 8) frame.flags |= IFOG_CAN_EXTENDED;

  bool remote = false;
  if (in.literal('#')) {
    if (!in.hex(digit)) return CandumpLine::malformed;
    frame.flags =
        static_cast<std::uint8_t>(frame.flags | IFOG_CAN_FD | ((digit & 1U) != 0 ? IFOG_CAN_BRS : 0));
    if (!parse_data(in, kFdBytes, frame)) return CandumpLine::malformed;
  } else if (in.literal('R') || in.literal('r')) {
    remote = true;
    in.hex(digit);
  } else if (!parse_data(in, kClassicBytes, frame)) {
    return CandumpLine::malformed;
  }
  if (in.literal('_') && !in.hex(digit)) return CandumpLine::malformed;  // the raw DLC of newer can-utils
  // Newer can-utils end the line with the direction, T or R.
  if (!in.done() && (!in.blanks() || in.word().size() != 1 || !in.done())) return CandumpLine::malformed;
  if (error) return CandumpLine::error;
  return remote ? CandumpLine::remote : CandumpLine::frame;
}

std::size_t format_candump_line(const ifog_can_frame& frame, std::string_view interface, char* out) noexcept {
  constexpr const char* kHex = "0123456789ABCDEF";
  char* at = out;
  const auto digits = [&](std::uint64_t value, int width, std::uint64_t base) {
    for (int i = width - 1; i >= 0; --i, value /= base) at[i] = kHex[value % base];
    at += width;
  };
  const auto micros = static_cast<std::uint64_t>(std::max<std::int64_t>(0, frame.arrival_ns) / 1000);
  *at++ = '(';
  digits(micros / 1'000'000, 10, 10);
  *at++ = '.';
  digits(micros % 1'000'000, 6, 10);
  *at++ = ')';
  *at++ = ' ';
  interface = interface.substr(0, 15);
  at = std::copy(interface.begin(), interface.end(), at);
  *at++ = ' ';
  digits(frame.id, (frame.flags & IFOG_CAN_EXTENDED) != 0 ? 8 : 3, 16);
  *at++ = '#';
  const bool fd = (frame.flags & IFOG_CAN_FD) != 0;
  if (fd) {
    *at++ = '#';
    *at++ = (frame.flags & IFOG_CAN_BRS) != 0 ? '1' : '0';
  }
  const std::size_t length = std::min<std::size_t>(frame.length, fd ? kFdBytes : kClassicBytes);
  for (std::size_t i = 0; i < length; ++i) digits(frame.data[i], 2, 16);
  *at++ = '\n';
  return static_cast<std::size_t>(at - out);
}

Candump read_candump(const std::string& path, std::string_view interface) {
  const std::string text = read_text_file(path);
  Candump log;
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    CandumpEntry entry;
    const CandumpLine kind = parse_candump_line(line, entry);
    if (kind == CandumpLine::malformed) {
      const char* why = rest.empty() && end == std::string_view::npos ? " (the file is cut off here)" : "";
      throw std::runtime_error(path + ":" + std::to_string(number) + ": '" + std::string(line.substr(0, 60)) +
                               "', " + kCandumpExpected + why);
    }
    if (kind == CandumpLine::blank || (!interface.empty() && entry.interface != interface)) continue;
    if (kind == CandumpLine::remote) ++log.remote;
    if (kind == CandumpLine::error) ++log.error;
    if (kind != CandumpLine::frame) continue;
    if (log.frames.empty()) log.interface = entry.interface;
    log.frames.push_back(entry.frame);
  }
  return log;
}

}  // namespace ifog

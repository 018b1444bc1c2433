// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/candump/candump.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <stdexcept>
#include <utility>

#include "drivers/capture/times/date_time.h"
#include "drivers/capture/times/text_cursor.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr std::uint32_t kExtendedFlag = 0x80000000U,
                        kErrorFlag = 0x20000000U;  // linux/can.h, as printed by candump
constexpr std::size_t kClassicBytes = 8, kFdBytes = 64;
constexpr std::size_t kEpochDigits = 10;

// Reads decimal digits; false for none or an overflow.
bool decimal(TextCursor& in, std::uint64_t& value, std::size_t& digits) {
  const std::string_view found = in.digits();
  digits = found.size();
  return std::from_chars(found.begin(), found.end(), value).ec == std::errc();
}

bool parse_seconds(TextCursor& in, std::int64_t& time_ns, std::size_t& second_digits) {
  std::uint64_t seconds = 0, fraction = 0;
  std::size_t digits = 0;
  constexpr std::uint64_t kMostSeconds = 9'000'000'000;  // limit of int64 in ns
  if (!decimal(in, seconds, second_digits) || seconds > kMostSeconds) return false;
  if (!in.literal('.') || !decimal(in, fraction, digits) || digits > 9) return false;
  for (; digits < 9; ++digits) fraction *= 10;
  time_ns = static_cast<std::int64_t>(seconds * 1'000'000'000 + fraction);
  return true;
}

// "(1436509052.249713)", or "(2026-05-01 12:00:00.123456)" of candump -t A.
bool parse_time(TextCursor& in, std::int64_t& time_ns, std::size_t& second_digits) {
  if (!in.literal('(')) return false;
  if (!in.has(4, '-')) return parse_seconds(in, time_ns, second_digits) && in.literal(')');
  const auto date = date_time(in.until(')'));
  if (!date || date->decimals > 9 || date->value < 0) return false;
  time_ns = static_cast<std::int64_t>(date->with(9));
  second_digits = kEpochDigits;
  return in.literal(')');
}

bool parse_data(TextCursor& in, std::size_t most, ifog_can_frame& frame) {
  std::size_t n = 0;
  std::uint32_t high = 0, low = 0;
  while (in.hex(high)) {
    if (n == most || !in.hex(low)) return false;
    frame.data[n++] = static_cast<std::uint8_t>(high << 4U | low);
    in.literal('.');  // notation of cansend
  }
  frame.length = static_cast<std::uint8_t>(n);
  return true;
}

bool parse_id(TextCursor& in, ifog_can_frame& frame, bool& error) {
  std::uint32_t id = 0, digit = 0;
  std::size_t digits = 0;
  for (; digits < 8 && in.hex(digit); ++digits) id = id << 4U | digit;
  if (digits != 3 && digits != 8) return false;
  error = digits == 8 && (id & kErrorFlag) != 0;
  if (digits == 3 ? id > 0x7FFU : (id & ~(kErrorFlag | kExtendedFlag)) > 0x1FFFFFFFU) return false;
  frame.id = id & 0x1FFFFFFFU;
  if (digits == 8) frame.flags |= IFOG_CAN_EXTENDED;
  return true;
}

// Part of a log line after "#".
CandumpLine parse_log(TextCursor& in, ifog_can_frame& frame) {
  std::uint32_t digit = 0;
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
  if (in.literal('_') && !in.hex(digit)) return CandumpLine::malformed;  // raw DLC of newer can-utils
  // Newer can-utils append the direction, T or R.
  if (!in.done() && (!in.blanks() || in.word().size() != 1 || !in.done())) return CandumpLine::malformed;
  return remote ? CandumpLine::remote : CandumpLine::frame;
}

// Part of a screen line after the id: "[8]  11 22 …"; raw DLC 9 … F for a length of 8 as "{8}".
CandumpLine parse_screen(TextCursor& in, ifog_can_frame& frame) {
  std::uint64_t length = 0;
  std::size_t digits = 0;
  std::uint32_t raw = 0;
  if (in.literal('{')) {
    if (!in.hex(raw) || !in.literal('}')) return CandumpLine::malformed;
    length = std::min<std::uint64_t>(raw, kClassicBytes);
  } else if (!in.literal('[') || !decimal(in, length, digits) || !in.literal(']')) {
    return CandumpLine::malformed;
  }
  if (digits == 2) frame.flags |= IFOG_CAN_FD;
  if (digits > 2 || length > (digits == 2 ? kFdBytes : kClassicBytes)) return CandumpLine::malformed;
  (void)in.blanks();
  if (in.at('r')) {
    const bool remote = in.word() == "remote" && in.blanks() && in.word() == "request";
    return remote ? CandumpLine::remote : CandumpLine::malformed;
  }
  std::uint32_t high = 0, low = 0;
  for (std::size_t i = 0; i < length; ++i) {
    if ((i > 0 && !in.blanks()) || !in.hex(high) || !in.hex(low)) return CandumpLine::malformed;
    frame.data[i] = static_cast<std::uint8_t>(high << 4U | low);
  }
  frame.length = static_cast<std::uint8_t>(length);
  if (in.done()) return CandumpLine::frame;
  if (length > 0 && !in.blanks()) return CandumpLine::malformed;
  return in.at('\'') || in.word() == "ERRORFRAME" ? CandumpLine::frame : CandumpLine::malformed;
}

// "DROPCOUNT: dropped 5 CAN frames on 'can0' socket (total drops 12)" of candump -d.
bool parse_drops(TextCursor in, CandumpEntry& entry) {
  std::size_t digits = 0;
  if (!in.text("DROPCOUNT: dropped ") || !decimal(in, entry.dropped, digits) || !in.text(" CAN frame"))
    return false;
  in.literal('s');
  if (!in.text(" on '")) return false;
  entry.interface = in.until('\'');
  return in.text("' socket (total drops ");
}

// "RX - -" or "TX B E" of candump -x.
bool pass_direction(TextCursor& in) {
  TextCursor ahead = in;
  const std::string_view direction = ahead.word();
  if (direction != "RX" && direction != "TX") return true;
  for (int i = 0; i < 2; ++i)
    if (!ahead.blanks() || ahead.word().size() != 1) return false;
  in = ahead;
  return in.blanks();
}

}  // namespace

CandumpLine parse_candump_line(std::string_view line, CandumpEntry& entry) noexcept {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t'))
    line.remove_suffix(1);
  // A tab starts candump -e's explanation of an error frame.
  if (line.empty() || line.front() == '#' || line.front() == '\t') return CandumpLine::blank;

  ifog_can_frame& frame = entry.frame;
  frame = ifog_can_frame{};
  entry.stamp = CandumpStamp::none;
  entry.dropped = 0;
  TextCursor in(line);
  if (in.at('D') && parse_drops(in, entry)) return CandumpLine::drops;
  (void)in.blanks();
  std::size_t digits = 0;
  const bool timed = in.at('(');
  if (timed && (!parse_time(in, frame.arrival_ns, digits) || !in.blanks())) return CandumpLine::malformed;
  entry.interface = in.word();
  if (entry.interface.empty() || !in.blanks() || !pass_direction(in)) return CandumpLine::malformed;

  bool error = false;
  if (!parse_id(in, frame, error)) return CandumpLine::malformed;
  CandumpLine kind = CandumpLine::malformed;
  if (in.literal('#')) {
    if (!timed) return CandumpLine::malformed;
    entry.stamp = CandumpStamp::absolute;
    kind = parse_log(in, frame);
  } else if (in.blanks()) {
    if (timed) entry.stamp = digits >= kEpochDigits ? CandumpStamp::absolute : CandumpStamp::since;
    kind = parse_screen(in, frame);
  }
  return error && kind != CandumpLine::malformed ? CandumpLine::error : kind;
}

std::int64_t CandumpClock::time_ns(const CandumpEntry& entry) noexcept {
  const std::int64_t stamp = entry.frame.arrival_ns;
  if (entry.stamp != CandumpStamp::since) return stamp;
  if (stamp < last_stamp_ns_) differences_ = true;
  last_stamp_ns_ = stamp;
  now_ns_ = differences_ ? std::min(now_ns_ + stamp, INT64_MAX / 2) : stamp;
  return now_ns_ + kShortStampsFrom_ns;
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

namespace {

// Reads a log's lines in order.
class Frames {
 public:
  Frames(std::string path, std::string_view interface, bool differences)
      : path_(std::move(path)), interface_(interface), clock_(differences) {}

  enum class Is { frame, nothing, end };
  Is take(std::string_view line, bool ended) {
    ++number_;
    if (line.size() > kLongestLine) refuse_long_line(path_, number_, line);
    const CandumpLine kind = parse_candump_line(line, entry_);
    if (kind == CandumpLine::malformed && (ended || !any_))
      throw std::runtime_error(path_ + ":" + std::to_string(number_) + ": " + in_quotes(line) + ", " +
                               kCandumpExpected);
    if (kind == CandumpLine::malformed || (kind == CandumpLine::frame && !ended && shortened())) {
      losses_.cut_off = true;
      return Is::end;
    }
    if (kind == CandumpLine::blank) return Is::nothing;
    if (kind == CandumpLine::drops) {
      if (interface_.empty() || entry_.interface == interface_) losses_.dropped += entry_.dropped;
      return Is::nothing;
    }
    any_ = true;
    // Differences are relative to the previous frame on any interface.
    entry_.frame.arrival_ns = clock_.time_ns(entry_);
    if (!interface_.empty() && entry_.interface != interface_) return Is::nothing;
    if (kind == CandumpLine::remote) ++losses_.remote;
    if (kind == CandumpLine::error) ++losses_.error;
    if (kind != CandumpLine::frame) return Is::nothing;
    lengths_[{entry_.frame.id, entry_.frame.flags}] = entry_.frame.length;
    return Is::frame;
  }

  [[nodiscard]] const CandumpEntry& entry() const { return entry_; }
  [[nodiscard]] const CandumpLosses& losses() const { return losses_; }

 private:
  // True if the last line, without an end, may have lost bytes although it parses.
  [[nodiscard]] bool shortened() const {
    const auto same = lengths_.find({entry_.frame.id, entry_.frame.flags});
    return same != lengths_.end() && entry_.frame.length < same->second;
  }

  std::string path_;
  std::string_view interface_;
  CandumpClock clock_;
  CandumpEntry entry_;
  CandumpLosses losses_;
  std::map<std::pair<std::uint32_t, std::uint8_t>, std::uint8_t> lengths_;  // of the last frame of each id
  std::size_t number_ = 0;
  bool any_ = false;
};

// Next line with a time in a log's beginning; false if there is none. An incomplete last line is ignored.
bool next_entry(std::string_view& beginning, CandumpEntry& entry) noexcept {
  for (std::size_t end = beginning.find('\n'); end != std::string_view::npos; end = beginning.find('\n')) {
    const CandumpLine kind = parse_candump_line(beginning.substr(0, end), entry);
    beginning.remove_prefix(end + 1);
    if (kind != CandumpLine::blank && kind != CandumpLine::malformed && kind != CandumpLine::drops)
      return true;
  }
  return false;
}

}  // namespace

std::string_view CandumpBuses::other(const ifog_can_frame& frame, std::string_view interface) noexcept {
  interface = interface.substr(0, kLongestName);
  const bool extended = (frame.flags & IFOG_CAN_EXTENDED) != 0;
  const auto end = seen_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto found = std::find_if(
      seen_.begin(), end, [&](const Seen& seen) { return seen.id == frame.id && seen.extended == extended; });
  if (found != end) return found->interface == interface ? std::string_view() : found->interface;
  if (count_ < seen_.size()) seen_[count_++] = {frame.id, extended, std::string(interface)};
  return {};
}

bool times_are_differences(std::string_view beginning) noexcept {
  CandumpEntry entry;
  std::int64_t before = 0;
  bool all_same = true;
  std::size_t n = 0;
  for (; next_entry(beginning, entry); ++n, before = entry.frame.arrival_ns) {
    if (entry.stamp != CandumpStamp::since) return false;
    if (n > 0 && entry.frame.arrival_ns < before) return true;
    if (n > 1 && entry.frame.arrival_ns != before) all_same = false;
  }
  return n > 2 && all_same && before > 0;
}

std::optional<std::int64_t> zero_of_stamps(std::string_view beginning) {
  CandumpEntry entry;
  if (!next_entry(beginning, entry) || entry.stamp == CandumpStamp::none) return std::nullopt;
  return entry.stamp == CandumpStamp::since ? kShortStampsFrom_ns : 0;
}

std::string first_interface(std::string_view beginning, const WantedFrame& wanted) {
  for (CandumpEntry entry; next_entry(beginning, entry);)
    if (wanted(entry.frame)) return std::string(entry.interface);
  return {};
}

CandumpLosses for_each_candump_frame(InputFile& file, std::string_view interface, const WantedFrame& wanted,
                                     const CandumpSink& sink) {
  CandumpBuses buses;
  const auto hand_on = [&](const ifog_can_frame& frame, std::string_view from) {
    // Two devices with one id would be mistaken for one.
    if (wanted(frame))
      if (const std::string_view other = buses.other(frame, from); !other.empty())
        throw std::runtime_error(file.path() + ": frames of one id come on " + in_quotes(other) + " and on " +
                                 in_quotes(from) +
                                 ", as from two devices, expected --channel with one of them");
    sink(frame, from);
  };
  Frames frames(file.path(), interface, times_are_differences(file.head()));
  TextPieces pieces([&file](char* to, std::size_t most) { return file.read_what_is_there(to, most); });
  for (std::string piece; pieces.next(piece);)
    for (std::string_view text = piece; !text.empty();) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      const bool ended = end < text.size();
      const Frames::Is is = frames.take(text.substr(0, end), ended);
      if (is == Frames::Is::end) return frames.losses();
      if (is == Frames::Is::frame) hand_on(frames.entry().frame, frames.entry().interface);
      text.remove_prefix(end + (ended ? 1 : 0));
    }
  return frames.losses();
}

}  // namespace ifog

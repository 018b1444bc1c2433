// SPDX-License-Identifier: Apache-2.0
// Logs of candump as a whole: what their times are, and whose frames come on which interface.
#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "drivers/capture/candump.h"
#include "drivers/capture/text_file.h"
#include "drivers/capture/text_lines.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

// Hands out one line at a time; `ended` says whether it had an end.
bool next_line(std::string_view& rest, std::string_view& line, bool& ended) {
  if (rest.empty()) return false;
  const std::size_t end = rest.find('\n');
  ended = end != std::string_view::npos;
  line = rest.substr(0, end);
  rest.remove_prefix(ended ? end + 1 : rest.size());
  return true;
}

// Times of candump -t d, told from those of -t z by the whole log.
class ShortTimes {
 public:
  // Whether they are differences, once a line tells.
  std::optional<bool> look(std::string_view line) {
    CandumpEntry entry;
    const CandumpLine kind = parse_candump_line(line, entry);
    if (kind == CandumpLine::blank || kind == CandumpLine::malformed || kind == CandumpLine::drops)
      return std::nullopt;
    if (entry.stamp != CandumpStamp::since) return false;
    if (n_ > 0 && entry.frame.arrival_ns < before_) return true;
    if (n_ > 1 && entry.frame.arrival_ns != before_) all_same_ = false;
    before_ = entry.frame.arrival_ns;
    ++n_;
    return std::nullopt;
  }
  // True at the end of a log in which none did.
  [[nodiscard]] bool at_end() const { return n_ > 2 && all_same_ && before_ > 0; }

 private:
  bool all_same_ = true;
  std::int64_t before_ = 0;
  std::size_t n_ = 0;
};

// next(line, ended): hands out one line at a time. nullopt: no line decides.
template <typename Next>
std::optional<bool> told_by(Next next, ShortTimes& times) {
  std::string_view line;
  std::optional<bool> told;
  for (bool ended = false; !told && next(line, ended);) told = times.look(line);
  return told;
}

std::optional<bool> told_by(std::string_view text, ShortTimes& times) {
  return told_by([&](std::string_view& line, bool& ended) { return next_line(text, line, ended); }, times);
}

bool are_differences(InputFile& file) {
  ShortTimes times;
  TextLines lines(file);
  return told_by([&](std::string_view& line, bool& ended) { return lines.next(line, ended); }, times)
      .value_or(times.at_end());
}

// A log's lines, one after the other.
class Frames {
 public:
  Frames(std::string path, std::string_view interface, bool differences)
      : path_(std::move(path)), interface_(interface) {
    if (differences) clock_.assume_differences();
  }

  enum class Is { frame, nothing, end };
  Is take(std::string_view line, bool ended) {
    ++number_;
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
    // Every line's time counts: a difference is to the frame before, whatever its interface.
    entry_.frame.arrival_ns = clock_.time_ns(entry_);
    if (!interface_.empty() && entry_.interface != interface_) return Is::nothing;
    if (kind == CandumpLine::remote) ++losses_.remote;
    if (kind == CandumpLine::error) ++losses_.error;
    if (kind == CandumpLine::xl) ++losses_.xl;
    if (kind != CandumpLine::frame) return Is::nothing;
    lengths_[{entry_.frame.id, entry_.frame.flags}] = entry_.frame.length;
    return Is::frame;
  }

  [[nodiscard]] const CandumpEntry& entry() const { return entry_; }
  [[nodiscard]] const CandumpLosses& losses() const { return losses_; }

 private:
  // Without its end a line may have lost bytes and still read as a frame.
  [[nodiscard]] bool shortened() const {
    const auto same = lengths_.find({entry_.frame.id, entry_.frame.flags});
    return same != lengths_.end() && entry_.frame.length < same->second;
  }

  std::string path_;
  std::string_view interface_;
  CandumpClock clock_;
  CandumpEntry entry_;
  CandumpLosses losses_;
  std::map<std::pair<std::uint32_t, std::uint8_t>, std::uint8_t> lengths_;  // of the last frame of an id
  std::size_t number_ = 0;
  bool any_ = false;
};

std::uint16_t number_of(std::vector<std::string>& interfaces, std::string_view interface) {
  const auto found = std::find(interfaces.begin(), interfaces.end(), interface);
  const auto number = static_cast<std::uint16_t>(found - interfaces.begin());
  if (found == interfaces.end()) {
    if (number == std::numeric_limits<std::uint16_t>::max())
      throw std::runtime_error("more than 65535 interfaces, this is no candump log");
    interfaces.emplace_back(interface);
  }
  return number;
}

}  // namespace

std::string_view CandumpBuses::other(const ifog_can_frame& frame, std::string_view interface) noexcept {
  interface = interface.substr(0, kLongestName);
  const bool extended = (frame.flags & IFOG_CAN_EXTENDED) != 0;
  auto* const end = seen_.begin() + count_;
  auto* const found = std::find_if(
      seen_.begin(), end, [&](const Seen& seen) { return seen.id == frame.id && seen.extended == extended; });
  if (found != end) {
    const std::string_view before(found->interface.data(), found->length);
    return before == interface ? std::string_view() : before;
  }
  if (count_ == seen_.size()) return {};
  Seen& seen = seen_[count_++];
  seen = {frame.id, extended, static_cast<std::uint8_t>(interface.size()), {}};
  std::copy(interface.begin(), interface.end(), seen.interface.begin());
  return {};
}

std::optional<std::int64_t> zero_of_stamps(std::string_view beginning) {
  std::string_view line;
  for (bool ended = false; next_line(beginning, line, ended);) {
    CandumpEntry entry;
    const CandumpLine kind = parse_candump_line(line, entry);
    if (kind == CandumpLine::blank || kind == CandumpLine::malformed || kind == CandumpLine::drops) continue;
    if (entry.stamp == CandumpStamp::none) return std::nullopt;
    return entry.stamp == CandumpStamp::since ? kShortStampsFrom_ns : 0;
  }
  return std::nullopt;
}

std::string first_interface(std::string_view beginning,
                            const std::function<bool(const ifog_can_frame&)>& wanted) {
  std::string_view line;
  bool ended = false;
  while (next_line(beginning, line, ended) && ended) {
    CandumpEntry entry;
    if (parse_candump_line(line, entry) == CandumpLine::frame && wanted(entry.frame))
      return std::string(entry.interface);
  }
  return {};
}

Candump read_candump(const std::string& path, std::string_view interface) {
  return parse_candump(read_text_file(path), path, interface);
}

Candump parse_candump(std::string_view text, const std::string& path, std::string_view interface) {
  Candump log;
  ShortTimes times;
  const std::optional<bool> told = told_by(text, times);
  Frames frames(path, interface, told.value_or(times.at_end()));
  std::string_view line;
  for (bool ended = false; next_line(text, line, ended);) {
    const Frames::Is is = frames.take(line, ended);
    if (is == Frames::Is::end) break;
    if (is == Frames::Is::nothing) continue;
    log.frames.push_back(frames.entry().frame);
    log.on.push_back(number_of(log.interfaces, frames.entry().interface));
  }
  static_cast<CandumpLosses&>(log) = frames.losses();
  return log;
}

CandumpLosses for_each_candump_frame(InputFile& file, std::string_view interface, const CandumpSink& sink) {
  ShortTimes times;
  std::optional<bool> differences = told_by(file.head(), times);
  if (!differences && !file.reopens()) {
    Candump log = parse_candump(file.text(), file.path(), interface);
    for (std::size_t i = 0; i < log.frames.size(); ++i) sink(log.frames[i], log.interfaces[log.on[i]]);
    return log;
  }
  if (!differences) {
    InputFile first(file.path());
    differences = are_differences(first);
  }
  Frames frames(file.path(), interface, *differences);
  TextLines lines(file);
  std::string_view line;
  for (bool ended = false; lines.next(line, ended);) {
    const Frames::Is is = frames.take(line, ended);
    if (is == Frames::Is::end) break;
    if (is == Frames::Is::frame) sink(frames.entry().frame, frames.entry().interface);
  }
  return frames.losses();
}

}  // namespace ifog

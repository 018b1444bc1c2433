// SPDX-License-Identifier: Apache-2.0
// Whole candump logs: meaning of their times, and frames by interface.
#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "drivers/capture/candump/candump.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
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

std::string first_interface(std::string_view beginning,
                            const std::function<bool(const ifog_can_frame&)>& wanted) {
  for (CandumpEntry entry; next_entry(beginning, entry);)
    if (wanted(entry.frame)) return std::string(entry.interface);
  return {};
}

CandumpLosses for_each_candump_frame(InputFile& file, std::string_view interface, const CandumpSink& sink) {
  Frames frames(file.path(), interface, times_are_differences(file.head()));
  TextPieces pieces([&file](char* to, std::size_t most) { return file.read_what_is_there(to, most); });
  for (std::string piece; pieces.next(piece);)
    for (std::string_view text = piece; !text.empty();) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      const bool ended = end < text.size();
      const Frames::Is is = frames.take(text.substr(0, end), ended);
      if (is == Frames::Is::end) return frames.losses();
      if (is == Frames::Is::frame) sink(frames.entry().frame, frames.entry().interface);
      text.remove_prefix(end + (ended ? 1 : 0));
    }
  return frames.losses();
}

}  // namespace ifog

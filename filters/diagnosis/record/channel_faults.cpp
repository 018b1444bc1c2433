#include "filters/diagnosis/record/channel_faults.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

namespace ifog {
namespace {

constexpr std::size_t kLookedAt = 50000;  // values, evenly chosen: what is usual shows in so many
constexpr double kAway = 0.2;    // spans of the usual values, the least of a slow channel's excursion
constexpr double kFar = 20.0;    // the same of a channel that is not slow
constexpr double kBeside = 0.3;  // of an excursion: as near it comes back to where it began
constexpr double kSlow = 0.1;    // of the span, the most that a slow channel moves in a sample
constexpr double kLongestExcursion_s = 60.0;
constexpr double kMostOfRecord = 0.02;  // in excursions together; the least of a stretch that stands still
constexpr double kJump = 8.0;           // usual changes
constexpr std::size_t kFewValues = 5;

double quantile(std::vector<double> values, double p) {
  const auto at = static_cast<std::ptrdiff_t>(p * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

// What is usual of a channel.
struct Usual {
  double low = 0.0, high = 0.0;  // hundredth and ninety-ninth quantile
  double change = 0.0;           // of one value to the next, where it changes: 95 % are smaller
  bool varied = false;           // more than a few values: a switch may be off for seconds
  bool slow = false;
};

Usual usual_of(std::span<const double> values) {
  Usual usual;
  std::vector<double> some, moves, changes;
  const std::size_t stride = std::max<std::size_t>(1, values.size() / kLookedAt);
  for (std::size_t i = 0; i < values.size(); i += stride)
    if (std::isfinite(values[i])) some.push_back(values[i]);
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double move = std::abs(values[i] - values[i - 1]);
    if (i % stride == 0 && std::isfinite(move)) moves.push_back(move);
    if (move > 0.0 && changes.size() < 4 * kLookedAt) changes.push_back(move);
  }
  if (some.size() < 100 || changes.empty()) return usual;
  usual.low = quantile(some, 0.01);
  usual.high = quantile(some, 0.99);
  usual.change = quantile(changes, 0.95);
  const std::set<double> different(some.begin(), some.end());
  usual.varied = different.size() > kFewValues;
  usual.slow = usual.varied && quantile(moves, 0.99) <= kSlow * (usual.high - usual.low);
  return usual;
}

struct Run {
  std::size_t from, to;  // samples [from, to)
};

// First sample from `from` on, within a minute, whose value is beside `value` again; none: it stays away.
std::optional<std::size_t> return_to(const Record& record, std::span<const double> values, std::size_t from,
                                     double value, double beside) {
  for (std::size_t i = from + 1;
       i < values.size() && record.time_s[i] - record.time_s[from] <= kLongestExcursion_s; ++i)
    if (std::abs(values[i] - value) <= beside) return i;
  return std::nullopt;
}

// Jumps as the channel never makes, and back again.
std::vector<Run> excursions(const Record& record, std::span<const double> values, const Usual& usual) {
  const double span = usual.high - usual.low;
  const double jump = usual.slow ? std::max(kJump * usual.change, kAway * span) : kFar * span;
  std::vector<Run> found;
  std::size_t samples = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double away = std::abs(values[i] - values[i - 1]);
    if (!(away > jump)) continue;
    const auto back = return_to(record, values, i, values[i - 1], kBeside * away);
    if (!back) continue;
    found.push_back({i, *back});
    samples += *back - i;
    i = *back;
  }
  if (static_cast<double>(samples) > kMostOfRecord * static_cast<double>(values.size())) return {};
  return found;
}

std::vector<Run> stuck_stretches(std::span<const double> values, const Usual& usual) {
  const auto least =
      static_cast<std::size_t>(kMostOfRecord * static_cast<double>(values.size())) + std::size_t{16};
  std::vector<Run> found;
  for (std::size_t from = 0; from < values.size();) {
    std::size_t to = from + 1;
    while (to < values.size() && values[to] == values[from]) ++to;
    if (to < values.size() && to - from >= least &&
        std::abs(values[to] - values[from]) > kJump * usual.change)
      found.push_back({from, to});
    from = to;
  }
  return found;
}

// Linear in time between the sample before the run and the one behind it; held where one of them is missing.
void interpolate(const Record& record, const Run& run, std::vector<double>& values) {
  const bool before = run.from > 0 && std::isfinite(values[run.from - 1]);
  const bool behind = run.to < values.size() && std::isfinite(values[run.to]);
  if (!before && !behind) return;
  const double first = before ? values[run.from - 1] : values[run.to];
  const double last = behind ? values[run.to] : first;
  const double from_s = record.time_s[before ? run.from - 1 : run.from];
  const double to_s = record.time_s[behind ? run.to : run.to - 1];
  for (std::size_t i = run.from; i < run.to; ++i) {
    const double share = to_s > from_s ? (record.time_s[i] - from_s) / (to_s - from_s) : 0.0;
    values[i] = first + share * (last - first);
  }
}

template <class... Values>
std::string text(const char* format, Values... values) {
  char line[160];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

std::string excursions_in_words(std::span<const double> values, const std::vector<Run>& found) {
  std::size_t samples = 0;
  for (const Run& run : found) samples += run.to - run.from;
  return text(
      " leaps away and back %zu time(s), for %zu sample(s) in all, first to %.6g: taken for faults of "
      "logging, interpolated",
      found.size(), samples, values[found.front().from]);
}

}  // namespace

RepairedRecords repair_channels(const std::vector<Record>& records) {
  RepairedRecords repaired;
  repaired.records = records;
  for (Record& record : repaired.records) {
    const std::string where = records.size() > 1 ? " (" + record.name + ")" : "";
    for (RecordChannel& channel : record.channels) {
      const Usual usual = usual_of(channel.values);
      if (!usual.varied) continue;
      const std::vector<Run> away = excursions(record, channel.values, usual);
      std::vector<double> values(channel.values.begin(), channel.values.end());
      for (const Run& run : away) interpolate(record, run, values);
      const std::vector<Run> stuck = usual.slow ? stuck_stretches(values, usual) : std::vector<Run>{};
      if (away.empty() && stuck.empty()) continue;
      if (!away.empty())
        repaired.remarks.push_back(channel.name + where + excursions_in_words(channel.values, away));
      for (const Run& run : stuck) {
        repaired.remarks.push_back(
            channel.name + where +
            text(" stands at %.6g from %.6g s to %.6g s and then jumps: taken for stuck, interpolated",
                 values[run.from], record.time_s[run.from] - record.time_s.front(),
                 record.time_s[run.to] - record.time_s.front()));
        interpolate(record, {run.from + 1, run.to}, values);
      }
      repaired.values.push_back(std::move(values));
      channel.values = repaired.values.back();
    }
  }
  return repaired;
}

}  // namespace ifog

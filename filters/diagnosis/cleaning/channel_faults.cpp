// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/channel_faults.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "filters/allan/stretches.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/words.h"
#include "filters/rest/glitches.h"
#include "filters/series/series_view.h"
#include "filters/threads/share_out.h"

namespace ifog {
namespace {

constexpr std::size_t kLookedAt = 50000;  // values, evenly chosen: what is usual shows in so many
constexpr double kAway = 0.2;    // spans of the usual values, the least of a slow channel's excursion
constexpr double kFar = 20.0;    // the same of a channel that is not slow
constexpr double kBeside = 0.3;  // of an excursion: as near it comes back to where it began
constexpr double kSlow = 0.1;    // of the span, the most that a slow channel moves in a sample
constexpr double kLongestExcursion_s = 60.0;
constexpr double kMostOfRecord = 0.02;  // in excursions together but for those to one number
constexpr double kMostNone = 0.1;       // of the record, without a reading
constexpr double kJump = 8.0;           // usual changes
constexpr double kPlaceholder = 30.0;   // interquartile ranges from the median
constexpr std::size_t kFewValues = 5;

// The first i in [from, to) with test(i); `to` if none is.
template <typename Test>
std::size_t first_where(ReadingAhead& ahead, std::size_t from, std::size_t to, const Test& test) {
  for (; from < to; ++from) {
    ahead.at(from);
    if (test(from)) break;
  }
  return from;
}

// What is usual of a channel.
struct Usual {
  double low = 0.0, high = 0.0;  // hundredth and ninety-ninth quantile
  double change = 0.0;           // of one value to the next, where it changes: 95 % are smaller
  bool varied = false;           // more than a few values: a switch may be off for seconds
  bool slow = false;
};

// Of what is so far away that no quantile may be made of it: a logger's 9999, should it be there for minutes.
void leave_out_placeholders(std::vector<double>& values) {
  const double middle = quantile(values, 0.5);
  const double far = kPlaceholder * (quantile(values, 0.75) - quantile(values, 0.25));
  if (far > 0.0) std::erase_if(values, [&](double value) { return std::abs(value - middle) > far; });
}

Usual usual_of(std::span<const double> values) {
  Usual usual;
  std::vector<double> some, moves, changes;
  const std::size_t stride = std::max<std::size_t>(1, values.size() / kLookedAt);
  for (std::size_t i = 0; i < values.size(); i += stride) some.push_back(values[i]);
  for (std::size_t i = stride; i < values.size(); i += stride)
    moves.push_back(std::abs(values[i] - values[i - 1]));
  ReadingAhead ahead(values);
  const auto changed = [&](std::size_t i) { return values[i] != values[i - 1]; };
  for (std::size_t i = 1; changes.size() < 4 * kLookedAt; ++i) {
    i = first_where(ahead, i, values.size(), changed);
    if (i >= values.size()) break;
    changes.push_back(std::abs(values[i] - values[i - 1]));
  }
  if (some.size() < 100 || changes.empty()) return usual;
  leave_out_placeholders(some);
  usual.low = quantile(some, 0.01);
  usual.high = quantile(some, 0.99);
  usual.change = quantile(changes, 0.95);
  const std::set<double> different(some.begin(), some.end());
  usual.varied = different.size() > kFewValues;
  usual.slow = usual.varied && quantile(moves, 0.99) <= kSlow * (usual.high - usual.low);
  return usual;
}

// A column without its missing values. What is there already is not copied.
struct Readings {
  explicit Readings(const Record& record, std::span<const double> column)
      : time_s(record.time_s), values(column) {
    bool whole = true;
    for_each_piece(column, 0, column.size(), [&](std::span<const double> some, std::size_t) {
      whole =
          whole && std::all_of(some.begin(), some.end(), [](double value) { return std::isfinite(value); });
    });
    if (whole) return;
    for (std::size_t i = 0; i < column.size(); ++i) {
      if (!std::isfinite(column[i])) continue;
      rows.push_back(i);
      times_.push_back(record.time_s[i]);
      values_.push_back(column[i]);
    }
    time_s = times_;
    values = values_;
  }
  Readings(const Readings&) = delete;
  Readings& operator=(const Readings&) = delete;

  [[nodiscard]] std::size_t row(std::size_t reading) const { return rows.empty() ? reading : rows[reading]; }

  std::span<const double> time_s, values;
  FiledVector<std::size_t> rows;  // of the readings; empty: all

 private:
  Samples times_, values_;
};

struct Run {
  std::size_t from, to;  // readings [from, to)
};

std::size_t samples_in(const std::vector<Run>& runs) {
  std::size_t samples = 0;
  for (const Run& run : runs) samples += run.to - run.from;
  return samples;
}

// First reading from `from` on, within a minute, whose value is beside `value` again; none: it stays away.
std::optional<std::size_t> return_to(const Readings& of, std::span<const double> values, std::size_t from,
                                     double value, double beside) {
  for (std::size_t i = from + 1; i < values.size() && of.time_s[i] - of.time_s[from] <= kLongestExcursion_s;
       ++i)
    if (std::abs(values[i] - value) <= beside) return i;
  return std::nullopt;
}

// One number again and again is what a logger writes where it has none, however often it does.
bool repeats(std::span<const double> values, const Run& run) {
  constexpr std::size_t kFewest = 3;
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(run.from);
  const auto last = values.begin() + static_cast<std::ptrdiff_t>(run.to);
  return run.to - run.from >= kFewest && std::all_of(first, last, [&](double v) { return v == *first; });
}

// Such a number, far from its neighbours, may stand for however long. But zero may be a reading, of what is
// switched off.
bool is_placeholder(std::span<const double> values, const Run& run, double far) {
  const double beside = run.from > 0 ? values[run.from - 1] : values[std::min(run.to, values.size() - 1)];
  return std::abs(values[run.from] - beside) > far && values[run.from] != 0.0 && repeats(values, run);
}

std::size_t end_of_one_value(std::span<const double> values, std::size_t from) {
  std::size_t to = from;
  while (to < values.size() && values[to] == values[from]) ++to;
  return to;
}

// Jumps as the channel never makes, and back again. A record may begin or end away: there one way is seen.
std::vector<Run> excursions(const Readings& of, std::span<const double> values, const Usual& usual) {
  const double span = usual.high - usual.low;
  const double jump = usual.slow ? std::max(kJump * usual.change, kAway * span) : kFar * span;
  const auto elsewhere = [&](double value) { return value > usual.high + jump || value < usual.low - jump; };
  const std::size_t n = values.size();
  std::vector<Run> found;
  std::size_t samples = 0, none = 0, i = 0;
  while (i < n && elsewhere(values[i])) ++i;
  if (i == n || of.time_s[i] - of.time_s[0] > kLongestExcursion_s) return {};
  if (i > 0) found.push_back({0, i});
  samples += i;
  ReadingAhead ahead(values);
  const auto jumps = [&](std::size_t at) { return std::abs(values[at] - values[at - 1]) > jump; };
  for (++i; i < n; ++i) {
    i = first_where(ahead, i, n, jumps);
    if (i >= n) break;
    const double away = std::abs(values[i] - values[i - 1]);
    auto back = return_to(of, values, i, values[i - 1], kBeside * away);
    const bool ends = of.time_s[n - 1] - of.time_s[i] <= kLongestExcursion_s;
    if (!back && ends && elsewhere(values[i])) back = n;
    if (const std::size_t to = end_of_one_value(values, i);
        !back && is_placeholder(values, {i, to}, kFar * span))
      back = to;
    if (!back) continue;
    found.push_back({i, *back});
    (repeats(values, {i, *back}) ? none : samples) += *back - i;
    i = *back;
  }
  const auto all = static_cast<double>(n);
  // A channel that leaps so often does it by itself, and a number that stands so often is one of its states.
  if (static_cast<double>(samples) > kMostOfRecord * all)
    std::erase_if(found, [&](const Run& run) { return !is_placeholder(values, run, kFar * span); });
  if (static_cast<double>(none) > kMostNone * all) found.clear();
  return found;
}

// Linear in time between the reading before the run and the one behind it; held where one of them is missing.
void interpolate(const Readings& of, const Run& run, Samples& values) {
  const bool before = run.from > 0;
  const bool behind = run.to < values.size();
  if (!before && !behind) return;
  const double first = before ? values[run.from - 1] : values[run.to];
  const double last = behind ? values[run.to] : first;
  const double from_s = of.time_s[before ? run.from - 1 : run.from];
  const double to_s = of.time_s[behind ? run.to : run.to - 1];
  for (std::size_t i = run.from; i < run.to; ++i) {
    const double share = to_s > from_s ? (of.time_s[i] - from_s) / (to_s - from_s) : 0.0;
    values[i] = first + share * (last - first);
  }
}

std::string excursions_in_words(std::span<const double> values, const std::vector<Run>& found) {
  return printed(
      " leaps away and back %zu time(s), for %zu sample(s) in all, first to %.6g: taken for faults of "
      "logging, interpolated for up to a minute",
      found.size(), samples_in(found), values[found.front().from]);
}

struct RepairedChannel {
  std::optional<Samples> values;  // none: it has no fault
  std::vector<std::string> remarks;
};

RepairedChannel repaired_channel(const Record& record, const RecordChannel& channel,
                                 const std::string& where) {
  RepairedChannel repaired;
  const Readings of(record, channel.values);
  const Usual usual = usual_of(of.values);
  if (!usual.varied) return repaired;
  const std::vector<Run> away = excursions(of, of.values, usual);
  if (away.empty()) return repaired;
  Samples values(of.values.begin(), of.values.end());
  for (const Run& run : away) interpolate(of, run, values);
  repaired.remarks.push_back(channel.name + where + excursions_in_words(of.values, away));
  for (const Run& run : away)
    if (of.time_s[run.to - 1] - of.time_s[run.from] > kLongestExcursion_s)
      for (std::size_t i = run.from; i < run.to; ++i) values[i] = std::nan("");
  if (of.rows.empty()) {
    repaired.values = std::move(values);
    return repaired;
  }
  Samples& all = repaired.values.emplace(channel.values.begin(), channel.values.end());
  for (std::size_t i = 0; i < values.size(); ++i) all[of.rows[i]] = values[i];
  return repaired;
}

// Which of them is meant.
std::string of_several(const std::vector<Record>& records, std::size_t r) {
  return records.size() > 1 ? " (" + records[r].name + ")" : "";
}

}  // namespace

RepairedRecords repair_channels(const std::vector<Record>& records, unsigned threads) {
  RepairedRecords repaired{records, {}, {}};
  struct Wanted {
    std::size_t record, channel;
  };
  std::vector<Wanted> wanted;
  for (std::size_t r = 0; r < records.size(); ++r)
    for (std::size_t c = 0; c < records[r].channels.size(); ++c) wanted.push_back({r, c});
  std::vector<RepairedChannel> each(wanted.size());
  share_out(wanted.size(), threads, [&](std::size_t i) {
    const auto [r, c] = wanted[i];
    each[i] = repaired_channel(records[r], records[r].channels[c], of_several(records, r));
  });
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto [r, c] = wanted[i];
    if (each[i].values)
      repaired.records[r].channels[c].values = repaired.values.emplace_back(std::move(*each[i].values));
    std::ranges::move(each[i].remarks, std::back_inserter(repaired.remarks));
  }
  return repaired;
}

RepairedRecords leave_out_knocks(const std::vector<Record>& records) {
  RepairedRecords repaired{records, {}, {}};
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Record& record = records[r];
    const bool plain = record.reference_radps.empty();
    const Samples less_reference = plain ? Samples() : error_of(record);
    const std::span<const double> error = plain ? record.rate_radps : std::span<const double>(less_reference);
    const Glitches glitches = find_glitches(error, stretches({}, error, {}));
    if (glitches.few.empty()) continue;
    Samples& rate = repaired.values.emplace_back(record.rate_radps.begin(), record.rate_radps.end());
    for (const Glitches::Leap& leap : glitches.few) rate[leap.sample] = std::nan("");
    repaired.records[r].rate_radps = rate;
    repaired.remarks.push_back(
        "the rate" + of_several(records, r) + ": " +
        in_words(glitches, [&](std::size_t i) { return record.origin.told(record.time_s[i]); }));
  }
  return repaired;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/rest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

#include "filters/rest/value_faults.h"
#include "filters/threads/share_out.h"
#include "filters/units/field_units.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr double kWindow_s = 0.5;
constexpr std::size_t kLeastWindow = 32;  // samples
constexpr double kSlowest_s = 2.0;        // sample time
constexpr double kDwell_s = 1.0;          // with references, slower samples may be dwells of a rate table
constexpr double kAround_s = 10.0;        // either side, of the running median
constexpr double kTurned = 20.0;          // times the usual step of quiet windows
constexpr double kLeastTurn = 1e-3;       // rad/s
constexpr double kCertain = 5.0;          // standard deviations
// Means of 1 s at rest scatter by 0.02 to 0.1 °/s for the noisiest MEMS gyros (data sheets, L3GD20 to LISY300).
constexpr double kMostNoise_radps = 0.2 * kDegree;
constexpr double kShaken = 4.0;
constexpr std::size_t kQuarters = 4;      // of a window
constexpr double kQuietest = 0.05;        // share of the record assumed quiet
constexpr std::size_t kShortestRest = 8;  // windows between two moving ones

enum class State : unsigned char { kResting, kShaking, kTurning };

std::vector<double> finite(std::span<const double> values) {
  std::vector<double> there;
  std::ranges::copy_if(values, std::back_inserter(there), [](double v) { return std::isfinite(v); });
  return there;
}

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(p * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Window {
  double mean = 0.0, scatter = 0.0;  // NaN: too few samples
};

// Uses four quarters, so that one outlier has no effect: the mean is that of the middle two, the scatter is
// the second smallest.
Window window_of(std::span<const double> rate) {
  std::array<double, kQuarters> level{}, scatter{};
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const std::size_t begin = q * rate.size() / kQuarters, end = (q + 1) * rate.size() / kQuarters;
    double n = 0.0, sum = 0.0, squares = 0.0;
    for (const double value : rate.subspan(begin, end - begin))
      if (std::isfinite(value)) n += 1.0, sum += value;
    if (n < 2.0) return {std::nan(""), std::nan("")};
    level[q] = sum / n;
    for (const double value : rate.subspan(begin, end - begin))
      if (std::isfinite(value)) squares += (value - level[q]) * (value - level[q]);
    scatter[q] = std::sqrt(squares / (n - 1.0));
  }
  std::ranges::sort(level);
  std::ranges::sort(scatter);
  return {0.5 * (level[1] + level[2]), scatter[1]};
}

std::size_t samples_of_window(double period_s) {
  return std::max(kLeastWindow, static_cast<std::size_t>(std::lround(kWindow_s / period_s)));
}

// Running median of the window means.
std::vector<double> running_median(const std::vector<Window>& windows, std::size_t around) {
  std::vector<double> out(windows.size());
  // On a coarser grid; a median over seconds changes slowly.
  const std::size_t step = std::max<std::size_t>(1, around / 8);
  for (std::size_t i = 0; i < windows.size(); i += step) {
    std::vector<double> near;
    const std::size_t low = i - std::min(i, around), high = std::min(windows.size(), i + around + 1);
    for (std::size_t j = low; j < high; ++j)
      if (std::isfinite(windows[j].mean)) near.push_back(windows[j].mean);
    const double median = quantile(std::move(near), 0.5);
    for (std::size_t j = i; j < std::min(windows.size(), i + step); ++j) out[j] = median;
  }
  return out;
}

// Smallest difference of neighbouring values: the converter's step if it is coarse.
double least_step(std::span<const double> rate) {
  double least = std::numeric_limits<double>::infinity(), before = std::nan("");
  for (const double value : rate) {
    const double step = std::abs(value - before);
    if (step > 0.0 && step < least) least = step;
    before = value;
  }
  return std::isfinite(least) ? least : 0.0;
}

// leap: by window, the largest step of all axes that exceeds noise and is no turn.
void mark_axis(const std::vector<Window>& windows, double window_s, double converter_step,
               std::vector<State>& state, std::vector<double>& leap) {
  // Medians of the shortest rest: by chance a single window's scatter may be half of the noise.
  std::vector<double> some, scatters, steps;
  for (const Window& window : windows) {
    if (window.scatter > 0.0) some.push_back(window.scatter);
    if (some.size() == kShortestRest) scatters.push_back(quantile(std::exchange(some, {}), 0.5));
  }
  if (scatters.empty()) scatters.push_back(quantile(std::move(some), 0.5));
  const double few = windows.size() < 2 * kShortestRest ? std::numeric_limits<double>::infinity() : 0.0;
  // Between two steps of a converter any noise scatters by half a step.
  const double shaken = std::max({few, kShaken * quantile(std::move(scatters), kQuietest), converter_step});
  for (std::size_t i = 1; i < windows.size(); ++i)
    if (windows[i].scatter <= shaken && windows[i - 1].scatter <= shaken)
      steps.push_back(std::abs(windows[i].mean - windows[i - 1].mean));
  // A normal variable is within 0.385 standard deviations in 30 % of cases.
  const double usual = std::max(few, quantile(std::move(steps), 0.3) / 0.385);
  const double noise = std::min(kTurned * usual, kCertain * kMostNoise_radps / std::sqrt(window_s));
  const auto around = static_cast<std::size_t>(std::lround(kAround_s / window_s));
  const std::vector<double> level = running_median(windows, std::max<std::size_t>(4, around));
  for (std::size_t i = 0; i < windows.size(); ++i) {
    if (!std::isfinite(windows[i].mean)) continue;
    // A long turn becomes the median itself, but it starts and ends with a step.
    const bool between = i > 0 && i + 1 < windows.size();
    const double across = between ? std::abs(windows[i + 1].mean - windows[i - 1].mean) : 0.0;
    const double away = std::abs(windows[i].mean - level[i]);
    const double most = std::max(away, std::isfinite(across) ? across : 0.0);
    if (most > std::max(kLeastTurn, noise))
      state[i] = State::kTurning;
    else if (noise > 0.0 && most > noise)
      leap[i] = std::max(leap[i], most);
    if (state[i] != State::kTurning && windows[i].scatter > shaken) state[i] = State::kShaking;
  }
}

// Adds one window on either side of motion, and rests that are too short.
void widen(std::vector<State>& state) {
  const std::vector<State> found = state;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] == State::kResting) continue;
    if (i > 0) state[i - 1] = std::max(state[i - 1], found[i]);
    if (i + 1 < found.size()) state[i + 1] = std::max(state[i + 1], found[i]);
  }
  for (std::size_t i = 0; i < state.size();) {
    std::size_t end = i;
    while (end < state.size() && state[end] == State::kResting) ++end;
    if (end - i < std::min(kShortestRest, state.size()))
      for (std::size_t j = i; j < end; ++j) state[j] = i > 0 ? state[i - 1] : state[end];
    i = std::max(end, i + 1);
  }
}

// A steady turn has little scatter. A rest between two turns counts only at the level of the longest rest. No rest
// has means that scatter more than those of any gyro.
void mark_other_turns(const std::vector<Window>& windows, double window_s, std::vector<State>& state) {
  struct Run {
    std::size_t begin, end;
    double mean;
  };
  std::vector<Run> runs;
  const auto turned = [&](std::size_t begin, std::size_t end) {
    std::fill(state.begin() + static_cast<std::ptrdiff_t>(begin),
              state.begin() + static_cast<std::ptrdiff_t>(end), State::kTurning);
  };
  for (std::size_t i = 0; i < state.size();) {
    std::size_t end = i;
    double sum = 0.0, count = 0.0, squares = 0.0, steps = 0.0, before = std::nan("");
    for (; end < state.size() && state[end] == State::kResting; ++end) {
      const double mean = windows[end].mean;
      if (!std::isfinite(mean)) continue;
      sum += mean, count += 1.0;
      if (std::isfinite(before)) squares += 0.5 * (mean - before) * (mean - before), steps += 1.0;
      before = mean;
    }
    if (squares * window_s > steps * kMostNoise_radps * kMostNoise_radps)
      turned(i, end);
    else if (count > 0.0)
      runs.push_back({i, end, sum / count});
    i = std::max(end, i + 1);
  }
  if (runs.size() < 2) return;
  const auto longest = std::ranges::max_element(runs, {}, [](const Run& run) { return run.end - run.begin; });
  for (const Run& run : runs) {
    const bool between = run.begin > 0 && run.end < state.size() && state[run.begin - 1] == State::kTurning &&
                         state[run.end] == State::kTurning;
    if (between && std::abs(run.mean - longest->mean) > 10.0 * kLeastTurn) turned(run.begin, run.end);
  }
}

// Two neighbouring windows that leap count once.
Rest::SlowTurns slow_turns_of(const std::vector<double>& leap, const std::vector<State>& state,
                              std::size_t window) {
  Rest::SlowTurns found;
  const auto leaps = [&](std::size_t i) { return leap[i] > 0.0 && state[i] == State::kResting; };
  for (std::size_t i = 0; i < leap.size(); ++i) {
    if (!leaps(i)) continue;
    found.largest_radps = std::max(found.largest_radps, leap[i]);
    if (i > 0 && leaps(i - 1)) continue;
    if (found.count++ == 0) found.first = i * window;
  }
  return found;
}

// For rows too far apart for windows: a row far from the others is a turn.
Rest::SlowTurns dwells_of(std::span<const std::span<const double>> axes) {
  Rest::SlowTurns found;
  for (const std::span<const double> values : axes) {
    const double level = quantile(finite(values), 0.5);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double away = std::abs(values[i] - level);
      if (!(away > kLeastTurn)) continue;
      if (found.count++ == 0 || i < found.first) found.first = i;
      found.largest_radps = std::max(found.largest_radps, away);
    }
  }
  return found;
}

Rest as_samples(const std::vector<State>& state, std::size_t window, std::size_t samples) {
  Rest rest;
  rest.samples = samples;
  for (std::size_t i = 0; i < state.size(); ++i) {
    const std::size_t begin = i * window, end = std::min(begin + window, samples);
    if (state[i] == State::kTurning) rest.turned += end - begin;
    if (state[i] == State::kShaking) rest.shaken += end - begin;
    if (state[i] != State::kResting) continue;
    if (!rest.at_rest.empty() && rest.at_rest.back().end == begin)
      rest.at_rest.back().end = end;
    else
      rest.at_rest.push_back({begin, end});
  }
  return rest;
}

// Per sample, because a rate that is set at each sample has no windows.
Rest rest_by_references(std::span<const std::span<const double>> references, std::size_t samples) {
  std::vector<State> state(std::max<std::size_t>(1, samples), State::kResting);
  for (const std::span<const double> values : references) {
    const double level = quantile(finite(values), 0.5);
    for (std::size_t i = 0; i < samples; ++i)
      if (std::abs(values[i] - level) > kLeastTurn) state[i] = State::kTurning;
  }
  return as_samples(state, 1, samples);
}

// Level of the quarter farthest from the mean, by medians, so that one outlier has no effect.
double farthest_quarter(std::span<const double> rate, double mean) {
  double farthest = mean;
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const double level =
        quantile(finite(rate.subspan(q * rate.size() / kQuarters, rate.size() / kQuarters)), 0.5);
    if (std::abs(level - mean) > std::abs(farthest - mean)) farthest = level;
  }
  return farthest;
}

// The last one ends with the record and may overlap the one before it. Needs a whole window. At the ends of the
// record no neighbour shows what moved in one quarter.
std::vector<Window> rest_windows(std::span<const double> rate, std::size_t window) {
  std::vector<Window> out;
  for (std::size_t begin = 0; begin < rate.size(); begin += window)
    out.push_back(window_of(rate.subspan(std::min(begin, rate.size() - window), window)));
  out.front().mean = farthest_quarter(rate.first(window), out.front().mean);
  out.back().mean = farthest_quarter(rate.last(window), out.back().mean);
  return out;
}

}  // namespace

Rest find_rest(std::span<const std::span<const double>> axes,
               std::span<const std::span<const double>> references, double period_s) {
  const std::size_t samples = axes.empty() ? 0 : axes.front().size();
  const std::size_t window = samples_of_window(period_s);
  const std::size_t count = samples < window ? 0 : (samples + window - 1) / window;
  std::vector<State> state(std::max<std::size_t>(1, count), State::kResting);
  if (period_s > kDwell_s && !references.empty()) return rest_by_references(references, samples);
  if (count == 0 || period_s > kSlowest_s) {
    Rest rest = as_samples(state, window, samples);
    rest.slow_turns = count == 0 ? Rest::SlowTurns{} : dwells_of(axes);
    return rest;
  }
  const double window_s = static_cast<double>(window) * period_s;
  std::vector<std::vector<Window>> windows(axes.size());
  share_out(axes.size(), 0, [&](std::size_t a) { windows[a] = rest_windows(axes[a], window); });
  std::vector<double> leap(count);
  for (std::size_t a = 0; a < axes.size(); ++a)
    mark_axis(windows[a], window_s, least_step(axes[a]), state, leap);
  widen(state);
  for (const std::vector<Window>& of_axis : windows) mark_other_turns(of_axis, window_s, state);
  Rest rest = as_samples(state, window, samples);
  rest.slow_turns = slow_turns_of(leap, state, window);
  if (rest.resting() > 0) return rest;
  std::vector<ValueFault> faults;
  for (std::span<const double> rate : axes)
    find_value_faults(rate, stretches({}, rate, {}), period_s, faults);
  for (const ValueFault& fault : faults)
    if (fault.name == "wrapped") rest.wrapped = "; " + fault.text;
  return rest;
}

std::string in_words(const Rest& rest, double period_s, double first_s) {
  if (rest.turned + rest.shaken == 0) return {};
  const auto seconds = [&](std::size_t n) { return static_cast<double>(n) * period_s; };
  std::string words = formatted("moving in %.4g of %.4g s (turned %.4g s, shaken %.4g s), at rest",
                                seconds(rest.turned + rest.shaken), seconds(rest.samples),
                                seconds(rest.turned), seconds(rest.shaken));
  constexpr std::size_t kShown = 4;
  std::vector<Stretch> longest = rest.at_rest;
  std::ranges::stable_sort(longest, std::ranges::greater{}, &Stretch::size);
  longest.resize(std::min(longest.size(), kShown));
  std::ranges::sort(longest, {}, &Stretch::begin);
  for (std::size_t i = 0; i < longest.size(); ++i) {
    words += (i > 0 ? ", " : " ") + told_time(first_s + seconds(longest[i].begin)) + " … " +
             told_time(first_s + seconds(longest[i].end)) + " s";
  }
  if (rest.at_rest.empty()) words += " nowhere";
  if (rest.at_rest.size() > kShown)
    words += " and " + std::to_string(rest.at_rest.size() - kShown) + " shorter parts";
  return words;
}

std::string slow_turns_in_words(const Rest& rest, double period_s, double first_s) {
  if (rest.slow_turns.count == 0) return {};
  return formatted(
      "the rate leaps by up to %.3g °/h, %zu times, first at %s s: slow turns (a rate table's dwells?) "
      "or a bias that jumps; the noise terms, K above all, take them for noise",
      rest.slow_turns.largest_radps / kDegreePerHour, rest.slow_turns.count,
      told_time(first_s + static_cast<double>(rest.slow_turns.first) * period_s).c_str());
}

void require_rest(const Rest& rest, double period_s, double first_s) {
  // The quietest samples count as rest in any record: so few prove none.
  const auto few = static_cast<std::size_t>(2.0 * kQuietest * static_cast<double>(rest.samples));
  if (rest.resting() > std::max(rest.turned, few)) return;
  const std::string was = "the sensor was " + in_words(rest, period_s, first_s) + rest.wrapped +
                          "; expected a record that is mostly at rest";
  if (!rest.at_rest.empty()) {
    const Stretch& longest = *std::ranges::max_element(rest.at_rest, {}, &Stretch::size);
    const auto time = [&](std::size_t i) { return told_time(first_s + static_cast<double>(i) * period_s); };
    throw std::invalid_argument(was + "; --from " + time(longest.begin) + " --to " + time(longest.end) +
                                " reads the longest rest");
  }
  // One window on either side counts as motion.
  const auto shortest = static_cast<double>((kShortestRest + 2) * samples_of_window(period_s)) * period_s;
  throw std::invalid_argument(
      was + formatted(", in the right unit; --from and --to read a rest of less than %.2g s", shortest));
}

std::vector<Stretch> common(std::span<const Stretch> a, std::span<const Stretch> b) {
  std::vector<Stretch> out;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    Stretch both{std::max(a[i].begin, b[j].begin), std::min(a[i].end, b[j].end)};
    // Only a hole between whole ends is one of the samples alone.
    if (!out.empty() && both.begin == a[i].begin && out.back().end == a[i - 1].end) both.lost = a[i].lost;
    if (both.begin < both.end) out.push_back(both);
    (a[i].end < b[j].end ? i : j) += 1;
  }
  return out;
}

}  // namespace ifog

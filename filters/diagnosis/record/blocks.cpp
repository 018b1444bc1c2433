// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/blocks.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "drivers/row_times/median.h"
#include "filters/allan/stretches.h"
#include "filters/diagnosis/record/step_means.h"
#include "filters/effects/meaning.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

// Fine steps per block; a lag is thus resolved to 1/16 of a block.
constexpr std::size_t kMostFine = 16;
// A block is valid if it has this share of its samples.
constexpr double kLeastShare = 0.5;
constexpr std::size_t kLeastBlocks = 32;
// A calibration by IEEE Std 952 has 11 points or more.
constexpr std::size_t kLeastDwells = 11;

std::string too_few(const std::vector<Record>& records, std::size_t blocks, double block_s) {
  std::size_t samples = 0;
  for (const Record& record : records)
    for (std::size_t i = 0; i < record.time_s.size(); ++i)
      if (std::isfinite(record.error(i))) ++samples;
  return formatted(
      "%zu samples with a rate (and a reference, if there is one) in %zu blocks of %.3g s that are at least "
      "half full: expected at least %zu of each. A long hole: diagnose each side by itself (--from, --to, or "
      "captures of their own). Rows with empty cells: drop them",
      samples, blocks, block_s, kLeastBlocks);
}

double median_period(const std::vector<Record>& records) {
  std::vector<double> steps;
  for (const Record& record : records) {
    const std::size_t n = std::min<std::size_t>(record.time_s.size(), 20001);
    for (std::size_t i = 1; i < n; ++i) steps.push_back(record.time_s[i] - record.time_s[i - 1]);
  }
  if (steps.empty()) throw std::invalid_argument(too_few(records, 0, 0.0));
  return median(std::move(steps));
}

// True period if stamps are rounded: at 128 Hz stamps in whole milliseconds have steps of 8 ms, seldom 7.
// From the first record, as all are of one sensor; the median for irregular rows such as a table's points.
double sample_period(const std::vector<Record>& records) {
  constexpr double kRounded = 1.0, kExact = 1e-9;  // of the median
  const double step_s = median_period(records);
  const double clock_s = sample_clock(records.front().time_s).period_s;
  const double apart = std::abs(clock_s / step_s - 1.0);
  return apart > kExact && apart < kRounded ? clock_s : step_s;
}

}  // namespace

void check_columns(const std::vector<Record>& records) {
  if (records.empty()) throw std::invalid_argument("a diagnosis needs a record");
  for (const Record& record : records) {
    const std::size_t n = record.time_s.size();
    if (n < 2)
      throw std::invalid_argument(record.name + ": " + std::to_string(n) + " samples, expected two at least");
    const auto same = [&](std::size_t size, const std::string& what) {
      if (size != n) {
        throw std::invalid_argument(record.name + ": " + what + " has " + std::to_string(size) +
                                    " values, time has " + std::to_string(n));
      }
    };
    same(record.rate_radps.size(), "the rate");
    if (record.reference_radps.empty() != records.front().reference_radps.empty())
      throw std::invalid_argument(record.name +
                                  ": either all captures have a reference rate or none, unlike " +
                                  records.front().name);
    if (!record.reference_radps.empty()) same(record.reference_radps.size(), "the reference");
    for (const RecordChannel& channel : record.channels) same(channel.values.size(), channel.name);
    for (std::size_t i = 1; i < n; ++i)
      if (!(record.time_s[i] > record.time_s[i - 1]))
        throw std::invalid_argument(record.name + ": time does not increase at sample " + std::to_string(i));
  }
}

double white_variance(const std::vector<Record>& records) {
  std::vector<double> differences;
  for (const Record& record : records) {
    const std::size_t n = record.rate_radps.size();
    const std::size_t stride = std::max<std::size_t>(1, n / 50000);
    for (std::size_t i = 1; i < n; i += stride) {
      const double d = record.error(i) - record.error(i - 1);
      if (std::isfinite(d)) differences.push_back(std::abs(d));
    }
  }
  if (differences.empty()) return 0.0;
  const double sigma = median(std::move(differences)) / 0.6744897501960817;
  return sigma * sigma / 2.0;
}

namespace {

// Slope of the error over the reference, from changes between neighbouring means of m samples.
struct MeansSlope {
  double value = 0.0, error = 0.0, pairs = 0.0;
};

MeansSlope slope_of_means(const std::vector<Record>& records, std::size_t m) {
  double xx = 0.0, xy = 0.0, yy = 0.0, n = 0.0;
  for (const Record& record : records) {
    double x_before = std::nan(""), y_before = std::nan("");
    for (std::size_t i = 0; i + m <= record.time_s.size(); i += m) {
      double x = 0.0, y = 0.0;
      for (std::size_t k = i; k < i + m; ++k) {
        x += record.reference_radps[k];
        y += record.rate_radps[k] - record.reference_radps[k];
      }
      const double dx = (x - std::exchange(x_before, x)) / static_cast<double>(m);
      const double dy = (y - std::exchange(y_before, y)) / static_cast<double>(m);
      if (std::isfinite(dx) && std::isfinite(dy)) xx += dx * dx, xy += dx * dy, yy += dy * dy, n += 1.0;
    }
  }
  if (!(xx > 0.0)) return {};
  const double value = xy / xx;
  return {value, std::sqrt(std::max(0.0, yy - value * xy) / n / xx), n};
}

// Samples per mean needed with a noisy reference (interpolated, or derived from angles). Its noise biases the
// slope of short means (errors in variables). Means are long enough if twice the length gives the same slope.
std::size_t long_enough(const std::vector<Record>& records) {
  constexpr std::size_t kLongest = 128;
  constexpr double kFewest = 60.0;  // changes; then the slope is known to 1/8 of its scatter
  constexpr double kSame = 0.01;    // relative; nonlinearity and rounding change slopes by as much
  constexpr double kWithin = 4.0;   // standard errors
  for (std::size_t m = 1; m < kLongest; m *= 2) {
    const MeansSlope one = slope_of_means(records, m), twice = slope_of_means(records, 2 * m);
    const double apart = std::abs(one.value - twice.value);
    if (twice.pairs < kFewest || apart <= std::max(kSame, kWithin * std::hypot(one.error, twice.error)))
      return m;
  }
  return kLongest;
}

// Sets the lengths of blocks and fine steps for at most `most_blocks` blocks.
BlockGrid steps_and_blocks(const std::vector<Record>& records, std::size_t most_blocks) {
  BlockGrid grid;
  grid.sample_s = sample_period(records);
  grid.white_variance = white_variance(records);
  double span = 0.0;
  for (const Record& record : records) span += record.time_s.back() - record.time_s.front() + grid.sample_s;
  const double samples = span / grid.sample_s;
  auto a_block = static_cast<std::size_t>(std::ceil(samples / static_cast<double>(most_blocks)));
  if (!records.front().reference_radps.empty() && grid.sample_s <= kSlowest_s) {
    const std::size_t least = long_enough(records);
    grid.noisy_reference = least > 1;
    a_block = std::max(a_block, least);
  }
  const std::size_t a_step = (a_block + kMostFine - 1) / kMostFine;
  grid.fine = (a_block + a_step - 1) / a_step;
  grid.fine_s = static_cast<double>(a_step) * grid.sample_s;
  grid.block_s = static_cast<double>(grid.fine) * grid.fine_s;
  return grid;
}

// Adds a record's blocks; returns the first samples of its fine steps.
StepStarts add_blocks_of(const Record& record, BlockGrid& grid, std::vector<double>& error) {
  const std::size_t steps = fine_index(record, record.time_s.size() - 1, grid.fine_s) + 1;
  const std::size_t blocks = (steps + grid.fine - 1) / grid.fine;
  grid.records.push_back({grid.size(), grid.size() + blocks, record.time_s[0] - record.since_power_up_s});
  grid.origin.push_back(record.origin);
  StepStarts first = step_starts(record, grid.fine_s, blocks * grid.fine);
  const double full = grid.block_s / grid.sample_s;
  for (std::size_t b = 0; b < blocks; ++b) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = first[b * grid.fine]; i < first[(b + 1) * grid.fine]; ++i) {
      const double value = record.error(i);
      if (std::isfinite(value)) sum += value, count += 1.0;
    }
    const bool enough = count >= std::max(1.0, kLeastShare * full);
    grid.valid.push_back(enough ? 1 : 0);
    error.push_back(enough ? sum / count : 0.0);
    grid.time_s.push_back(record.time_s[0] + (static_cast<double>(b) + 0.5) * grid.block_s -
                          0.5 * grid.fine_s);
  }
  return first;
}

// values: by record.
FineChannel fine_channel(const BlockGrid& grid, const std::vector<StepStarts>& starts,
                         const std::string& name, const std::vector<std::span<const double>>& values,
                         bool two_valued = false) {
  FineChannel channel;
  channel.name = name;
  channel.two_valued = two_valued;
  const bool several = grid.fine_s > grid.sample_s;  // samples per step > 1
  // What is reconstructed from its readings; a rate that is set in two levels is no coarse one.
  const bool read = !two_valued && !is_reference_rate(name) && axis_of_rate(name).empty();
  for (std::size_t r = 0; r < values.size(); ++r) {
    const StepMeans steps =
        step_means(values[r], starts[r], several, two_valued, read && is_coarse(values[r]));
    channel.values.insert(channel.values.end(), steps.means.begin(), steps.means.end());
    channel.power.insert(channel.power.end(), steps.power.begin(), steps.power.end());
    channel.read.insert(channel.read.end(), steps.read.begin(), steps.read.end());
  }
  const auto [low, high] = std::ranges::minmax(channel.values);
  channel.low = low;
  channel.high = high;
  channel.varies = high - low > 1e-9 * std::max({std::abs(low), std::abs(high), 1e-300});
  return channel;
}

// True if a channel of unknown quantity has exactly two values. (A thermometer in whole degrees may have two,
// too.)
bool is_switch(const std::vector<Record>& records, const std::string& name) {
  if (kind_of(name) != ChannelKind::kOther) return false;
  std::set<double> different;
  for (const Record& record : records)
    for (const double value : values_of(record, name)) {
      if (std::isfinite(value)) different.insert(value);
      if (different.size() > 2) return false;
    }
  return different.size() == 2;
}

}  // namespace

std::size_t BlockGrid::used() const {
  return static_cast<std::size_t>(std::count(valid.begin(), valid.end(), std::uint8_t{1}));
}

std::size_t BlockGrid::longest() const {
  std::size_t most = 0;
  for (const BlockRange& record : records) most = std::max(most, record.size());
  return most;
}

std::optional<std::size_t> BlockData::index_of(std::string_view name) const {
  const auto found = std::ranges::find(channels, name, &FineChannel::name);
  if (found == channels.end()) return std::nullopt;
  return static_cast<std::size_t>(found - channels.begin());
}

BlockData cut_to_blocks(const std::vector<Record>& records, std::size_t most_blocks) {
  check_columns(records);
  BlockData data;
  data.grid = steps_and_blocks(records, most_blocks);
  std::vector<double> error;
  std::vector<StepStarts> starts;  // by record
  starts.reserve(records.size());
  for (const Record& record : records) starts.push_back(add_blocks_of(record, data.grid, error));
  data.grid.error = Eigen::Map<Eigen::VectorXd>(error.data(), static_cast<Eigen::Index>(error.size()));
  for (const RecordChannel& channel : records.front().channels) {
    std::vector<std::span<const double>> values;
    for (const Record& record : records) values.push_back(values_of(record, channel.name));
    if (std::ranges::any_of(values, [](const auto& each) { return each.empty(); })) continue;
    data.channels.push_back(
        fine_channel(data.grid, starts, channel.name, values, is_switch(records, channel.name)));
    data.channels.back().of_axis = !axis_of_rate(channel.name).empty();
    data.channels.back().period = channel.period;
  }
  if (!records.front().reference_radps.empty()) {
    std::vector<std::span<const double>> values;
    for (const Record& record : records) values.push_back(record.reference_radps);
    data.reference = static_cast<std::ptrdiff_t>(data.channels.size());
    data.channels.push_back(fine_channel(data.grid, starts, records.front().reference_name, values));
    // Averages over seconds at set rates: drift between them is not sampled.
    data.grid.dwells = data.grid.sample_s > kSlowest_s && data.channels.back().varies;
  }
  if (data.grid.used() < (data.grid.dwells ? kLeastDwells : kLeastBlocks))
    throw std::invalid_argument(too_few(records, data.grid.used(), data.grid.block_s));
  return data;
}

}  // namespace ifog

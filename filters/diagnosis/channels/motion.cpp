// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/channels/motion.h"

#include <cmath>

#include "filters/effects/meaning.h"
#include "filters/series/finite_sum.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

// Means of this length keep 10 % of the variance of an acceleration on a sled or tumble table. Traffic, sway,
// swell and body waves of an earthquake are faster.
constexpr double kHeld_s = 30.0;
constexpr double kHeldShare = 0.1;
// Means of this length keep most of the power of towers, bridges, seas, suspensions and surface waves (1 Hz
// and slower), and less of that of machines.
constexpr double kSwing_s = 0.5;
// Required gain of twice the log-likelihood of a slope: by chance one in 10^6, with 100 tries.
constexpr double kCertainMotion = 40.0;
constexpr double kOfRate = 0.02;  // of the rate's variance; smaller shares are not reported

// Linear dependence of y on x.
struct Likeness {
  double share = 0.0, gain = 0.0;  // of y's variance; twice the log-likelihood
};

// Uses changes from block to block, so that slow drifts do not count.
Likeness likeness_of(const BlockGrid& grid, const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
  double xx = 0.0, xy = 0.0, yy = 0.0, n = 0.0;
  for (const BlockRange& record : grid.records)
    for (std::size_t b = record.first + 2; b < record.end; ++b) {
      if (!grid.valid[b] || !grid.valid[b - 1] || !grid.valid[b - 2]) continue;
      const auto k = static_cast<Eigen::Index>(b);
      const double dx = x[k] - x[k - 1], dy = y[k] - y[k - 1];
      xx += dx * dx, xy += dx * dy, yy += dy * dy, n += 1.0;
    }
  if (!(xx > 0.0) || !(yy > 0.0)) return {};
  const double share = xy * xy / xx / yy;
  return {share, -n * std::log(std::max(1e-12, 1.0 - share))};
}

// Change over two blocks, centred.
Eigen::VectorXd change_of(const BlockGrid& grid, const Eigen::VectorXd& x) {
  Eigen::VectorXd change = Eigen::VectorXd::Zero(x.size());
  for (const BlockRange& record : grid.records)
    for (Eigen::Index k = record.row() + 1; k + 1 < record.row() + record.rows(); ++k)
      change[k] = x[k + 1] - x[k - 1];
  return change;
}

// Sentence on what the channel would explain, or empty.
std::string rotation_in_words(const BlockData& data, std::size_t c) {
  const Eigen::VectorXd value = column(data, ShapeSettings{}, c);
  const Likeness by_value = likeness_of(data.grid, value, data.grid.error);
  const Likeness by_change = likeness_of(data.grid, change_of(data.grid, value), data.grid.error);
  const bool change = by_change.gain > by_value.gain;
  const Likeness& best = change ? by_change : by_value;
  if (best.gain < kCertainMotion || best.share < kOfRate) return "";
  return formatted("%.0f %% of the changes of the rate go with the %s of ", 100.0 * best.share,
                   change ? "change" : "value") +
         data.channels[c].name + ", as a sway or a ride does: that is rotation and stays in the rate";
}

// Share of a channel's variance in means of `count` samples. The grid of a long record does not show fast
// changes.
double kept_by_means(const std::vector<Record>& records, const std::string& name, double count) {
  const auto each = static_cast<std::size_t>(std::max(1.0, std::round(count)));
  double all = 0.0, kept = 0.0;
  for (const Record& record : records) {
    const std::span<const double> values = values_of(record, name);
    const auto [total, there] = finite_sum(values);
    for (std::size_t from = 0; from + each <= values.size(); from += each) {
      double sum = 0.0, square = 0.0;
      for (const double value : values.subspan(from, each)) {
        sum += value - total / there;
        square += std::pow(value - total / there, 2);
      }
      if (!std::isfinite(square)) continue;
      all += square;
      kept += sum * sum / static_cast<double>(each);
    }
  }
  return all > 0.0 ? kept / all : 0.0;
}

}  // namespace

std::vector<std::string> mark_motion(const std::vector<Record>& records, BlockData& data, bool allowed) {
  std::vector<std::string> said;
  if (data.reference >= 0 || allowed) return said;
  std::string names;
  for (std::size_t c = 0; c < data.channels.size(); ++c) {
    FineChannel& channel = data.channels[c];
    const Motion motion = motion_of(channel.name);
    if (!channel.varies || motion == Motion::kNone) continue;
    channel.moves = true;
    if (motion == Motion::kAcceleration) {
      const double each_s = data.grid.sample_s;
      channel.held = kept_by_means(records, channel.name, kHeld_s / each_s) > kHeldShare;
      channel.shakes = kept_by_means(records, channel.name, kSwing_s / each_s) < 0.5;
    }
    names += (names.empty() ? "" : ", ") + channel.name;
    if (std::string words = rotation_in_words(data, c); !words.empty()) said.push_back(std::move(words));
  }
  if (!names.empty())
    said.push_back(
        "without a reference rate nothing but the power of its vibration is traced to what senses motion (" +
        names +
        "), for it may be rotation: a capture with a reference rate would show which, or the "
        "same motion with the sensor's axis reversed (--allow-motion-channels treats it as error)");
  return said;
}

}  // namespace ifog

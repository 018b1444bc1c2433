// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/followed_channel.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include "filters/allan/angle_sum.h"
#include "filters/series/samples.h"

namespace ifog {
namespace {

constexpr std::size_t kSlowMeans = 32;  // per record; temperature is slower
constexpr std::size_t kFewestMeans = 16;
// Two independent random walks reach this squared correlation in one of ten records.
constexpr double kLeastShare = 0.7;

// Means of the rate at rest and of the channel over the same rows.
struct Pairs {
  std::vector<double> rate, channel;
};

Pairs pairs_of(std::span<const double> rate, std::span<const Stretch> parts, std::size_t first_row,
               const ChannelOutline& channel) {
  const std::size_t group = std::max<std::size_t>(1, channel.means().size() / kSlowMeans),
                    rows = group * channel.rows();
  const std::size_t begin = (first_row + rows - 1) / rows;  // first group inside the record
  Pairs pairs;
  for (std::size_t g = begin; (g + 1) * group <= channel.means().size(); ++g) {
    const std::size_t from = g * rows - first_row, to = from + rows;
    if (to > rate.size()) break;
    const auto rests = [&](const Stretch& part) { return part.begin <= from && to <= part.end; };
    if (std::ranges::none_of(parts, rests)) continue;
    double values = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < group; ++i) values += channel.means()[g * group + i];
    for (std::size_t i = from; i < to; ++i) sum += rate[i];
    if (std::isnan(values)) continue;
    pairs.rate.push_back(sum / static_cast<double>(rows));
    pairs.channel.push_back(values / static_cast<double>(group));
  }
  return pairs;
}

struct Line {
  double slope = 0.0, share = 0.0;
};
Line line_of(const Pairs& pairs) {
  if (pairs.rate.size() < kFewestMeans) return {};
  const Eigen::Map<const Eigen::ArrayXd> rate(pairs.rate.data(), std::ssize(pairs.rate)),
      channel(pairs.channel.data(), std::ssize(pairs.channel));
  const Eigen::ArrayXd x = channel - channel.mean(), y = rate - rate.mean();
  const double xx = x.square().sum(), xy = (x * y).sum(), yy = y.square().sum();
  return xx > 0.0 && yy > 0.0 ? Line{xy / xx, xy * xy / (xx * yy)} : Line{};
}

// The rate minus the line, linearly interpolated between the centres of the channel's means.
Samples less_line(std::span<const double> rate, std::size_t first_row, const ChannelOutline& channel,
                  double slope) {
  const std::vector<double>& means = channel.means();
  const auto rows = static_cast<double>(channel.rows()), last = static_cast<double>(means.size() - 1);
  Samples less;
  less.reserve(rate.size());
  for (std::size_t i = 0; i < rate.size(); ++i) {
    const double at = std::clamp((static_cast<double>(first_row + i) + 0.5) / rows - 0.5, 0.0, last);
    const auto left = static_cast<std::size_t>(at), right = std::min(left + 1, means.size() - 1);
    const double value = means[left] + (at - std::floor(at)) * (means[right] - means[left]);
    less.push_back(rate[i] - (std::isnan(value) ? 0.0 : slope * value));
  }
  return less;
}

}  // namespace

std::optional<FollowedChannel> followed_channel(std::span<const double> rate, std::span<const Stretch> parts,
                                                std::size_t first_row, double period_s,
                                                std::span<const ChannelOutline> channels,
                                                NoiseCoefficients& found) {
  if (!found.B.present && !found.K.present && !found.R.present) return std::nullopt;
  const ChannelOutline* best = nullptr;
  Line line;
  for (const ChannelOutline& channel : channels)
    if (const Line here = line_of(pairs_of(rate, parts, first_row, channel));
        here.share > std::max(kLeastShare, line.share))
      best = &channel, line = here;
  if (best == nullptr) return std::nullopt;
  const Samples less = less_line(rate, first_row, *best, line.slope);
  NoiseCoefficients without;
  try {
    without = noise_coefficients(AngleSum(less, parts), period_s);
  } catch (const std::invalid_argument&) {  // the channel explains everything
  }
  for (const auto term : {&NoiseCoefficients::B, &NoiseCoefficients::K, &NoiseCoefficients::R}) {
    NoiseCoefficient& c = found.*term;
    if (c.present) c.std_error = std::hypot(c.std_error, c.value - (without.*term).value);
  }
  return FollowedChannel{best->name(), line.share};
}

}  // namespace ifog

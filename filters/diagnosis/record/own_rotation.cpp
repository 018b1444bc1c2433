// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/own_rotation.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "filters/effects/meaning.h"

namespace ifog {
namespace {

constexpr double kStandardGravity = 9.80665;  // m/s^2
constexpr std::size_t kFewestChanges = 50;    // changes of the angle that tell
constexpr std::size_t kLongestMean = 64;
// Twice the log-likelihood that the slope has to gain, the lengths tried and a swing's few independent
// periods included.
constexpr double kCertainSlope = 60.0;
// Of 1/g, the slope of a tilt about the sensor's own axis. Below the first it might be an error (0.003 of 1/g
// is 60 deg/h for a change of 1 m/s^2 each second), above the second it is no tilt.
constexpr double kLeastOfGravity = 0.003, kMostOfGravity = 2.0;

struct TiltSlope {
  double value = 0.0, correlation = 0.0;
  double gain = 0.0;  // twice the log-likelihood
};

// The angle turned at the middle of each block of its record, rad.
Eigen::VectorXd angles_of(const BlockGrid& grid) {
  Eigen::VectorXd angle(grid.error.size());
  for (const BlockRange& record : grid.records) {
    double turned = 0.0;
    for (Eigen::Index b = record.row(); b < record.row() + record.rows(); ++b) {
      angle[b] = turned + 0.5 * grid.error[b] * grid.block_s;
      turned += grid.error[b] * grid.block_s;
    }
  }
  return angle;
}

// Changes from one mean over so many blocks to the next, of what lies within valid stretches of a record.
std::vector<std::pair<double, double>> angle_changes(const BlockGrid& grid, const Eigen::VectorXd& force,
                                                     const Eigen::VectorXd& angle, std::size_t blocks) {
  std::vector<std::pair<double, double>> found;
  const auto step = static_cast<Eigen::Index>(blocks);
  for (const BlockRange& record : grid.records) {
    std::size_t b = record.first;
    while (b + 2 * blocks <= record.end) {
      std::size_t bad = b + 2 * blocks;
      while (bad > b && grid.valid[bad - 1]) --bad;
      if (bad > b) {
        b = bad;
        continue;
      }
      const auto at = static_cast<Eigen::Index>(b);
      found.emplace_back(force.segment(at + step, step).mean() - force.segment(at, step).mean(),
                         angle.segment(at + step, step).mean() - angle.segment(at, step).mean());
      b += blocks;
    }
  }
  return found;
}

TiltSlope tilt_slope(const std::vector<std::pair<double, double>>& pairs) {
  const auto n = static_cast<double>(pairs.size());
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (const auto& [force, angle] : pairs) x += force / n, y += angle / n;
  for (const auto& [force, angle] : pairs) {
    xx += (force - x) * (force - x);
    xy += (force - x) * (angle - y);
    yy += (angle - y) * (angle - y);
  }
  if (!(xx > 0.0) || !(yy > 0.0)) return {};
  TiltSlope slope{xy / xx, xy / std::sqrt(xx * yy), 0.0};
  slope.gain = -n * std::log(std::max(1e-12, 1.0 - slope.correlation * slope.correlation));
  return slope;
}

// Over the length at which it is clearest.
TiltSlope clearest_slope(const BlockGrid& grid, const Eigen::VectorXd& force, const Eigen::VectorXd& angle) {
  TiltSlope best;
  for (std::size_t blocks = 1; blocks <= kLongestMean; blocks *= 2) {
    const auto pairs = angle_changes(grid, force, angle, blocks);
    if (pairs.size() < kFewestChanges) break;
    const TiltSlope slope = tilt_slope(pairs);
    if (slope.gain > best.gain) best = slope;
  }
  return best;
}

std::string in_words(const std::string& channel, const TiltSlope& slope, double gravity) {
  std::array<char, 400> text{};
  std::snprintf(
      text.data(), text.size(),
      "%s tells how the sensor itself tilts: the angle turned changes with it by %.2g of what gravity "
      "gives (correlation %.2f). That is rotation and stays in the rate; without a reference rate no "
      "error is traced to %s",
      channel.c_str(), std::abs(slope.value) * gravity, std::abs(slope.correlation), channel.c_str());
  return text.data();
}

}  // namespace

std::vector<std::string> mark_own_rotation(BlockData& data) {
  std::vector<std::string> said;
  if (data.reference >= 0 || data.grid.dwells) return said;
  const Eigen::VectorXd angle = angles_of(data.grid);
  for (std::size_t c = 0; c < data.channels.size(); ++c) {
    FineChannel& channel = data.channels[c];
    if (kind_of(channel.name) != ChannelKind::kAcceleration || !channel.varies) continue;
    const TiltSlope slope = clearest_slope(data.grid, column(data, ShapeSettings{}, c), angle);
    const double gravity = unit_of(channel.name) == "g" ? 1.0 : kStandardGravity;
    const double of_gravity = std::abs(slope.value) * gravity;
    if (!(slope.gain > kCertainSlope) || of_gravity < kLeastOfGravity || of_gravity > kMostOfGravity)
      continue;
    channel.rotates = true;
    said.push_back(in_words(channel.name, slope, gravity));
  }
  return said;
}

}  // namespace ifog

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

// Of the rate, rad/s for 1 m/s^2, from where it is a curve's and no error: 2000 deg/h for 1 g. Of gyros that
// are sensitive to acceleration the worst have a tenth of it.
constexpr double kLeastOfCurve = 1e-3;

struct RotationSlope {
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
std::vector<std::pair<double, double>> changes_of(const BlockGrid& grid, const Eigen::VectorXd& force,
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

RotationSlope rotation_slope(const std::vector<std::pair<double, double>>& pairs) {
  const auto n = static_cast<double>(pairs.size());
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (const auto& [force, angle] : pairs) x += force / n, y += angle / n;
  for (const auto& [force, angle] : pairs) {
    xx += (force - x) * (force - x);
    xy += (force - x) * (angle - y);
    yy += (angle - y) * (angle - y);
  }
  if (!(xx > 0.0) || !(yy > 0.0)) return {};
  RotationSlope slope{xy / xx, xy / std::sqrt(xx * yy), 0.0};
  slope.gain = -n * std::log(std::max(1e-12, 1.0 - slope.correlation * slope.correlation));
  return slope;
}

// Over the length at which it is clearest.
RotationSlope clearest_slope(const BlockGrid& grid, const Eigen::VectorXd& force,
                             const Eigen::VectorXd& angle) {
  RotationSlope best;
  for (std::size_t blocks = 1; blocks <= kLongestMean; blocks *= 2) {
    const auto pairs = changes_of(grid, force, angle, blocks);
    if (pairs.size() < kFewestChanges) break;
    const RotationSlope slope = rotation_slope(pairs);
    if (slope.gain > best.gain) best = slope;
  }
  return best;
}

std::string tilt_in_words(const std::string& channel, const RotationSlope& slope, double gravity) {
  std::array<char, 400> text{};
  std::snprintf(
      text.data(), text.size(),
      "%s tells how the sensor itself tilts: the angle turned changes with it by %.2g of what gravity "
      "gives (correlation %.2f). That is rotation and stays in the rate; without a reference rate no "
      "error is traced to %s",
      channel.c_str(), std::abs(slope.value) * gravity, std::abs(slope.correlation), channel.c_str());
  return text.data();
}

std::string curve_in_words(const std::string& channel, const RotationSlope& slope) {
  std::array<char, 400> text{};
  std::snprintf(
      text.data(), text.size(),
      "%s goes with the rate as in a curve, at %.2g m/s (correlation %.2f). That is rotation and stays in "
      "the rate; without a reference rate no error is traced to %s",
      channel.c_str(), 1.0 / std::abs(slope.value), std::abs(slope.correlation), channel.c_str());
  return text.data();
}

// One sentence where the acceleration is the sensor's own rotation; else empty.
std::string look_at_acceleration(const BlockData& data, std::size_t c, const Eigen::VectorXd& angle) {
  const std::string& name = data.channels[c].name;
  const Eigen::VectorXd force = column(data, ShapeSettings{}, c);
  const double gravity = unit_of(name) == "g" ? 1.0 : kStandardGravity;
  const RotationSlope tilt = clearest_slope(data.grid, force, angle);
  const double of_gravity = std::abs(tilt.value) * gravity;
  if (tilt.gain > kCertainSlope && of_gravity >= kLeastOfGravity && of_gravity <= kMostOfGravity)
    return tilt_in_words(name, tilt, gravity);
  RotationSlope curve = clearest_slope(data.grid, force, data.grid.error);
  curve.value *= gravity / kStandardGravity;
  return curve.gain > kCertainSlope && std::abs(curve.value) >= kLeastOfCurve ? curve_in_words(name, curve)
                                                                              : "";
}

std::string motion_in_words(const std::vector<std::string>& channels) {
  std::string list;
  for (std::size_t i = 0; i < channels.size(); ++i)
    list += (i == 0 ? "" : i + 1 == channels.size() ? " and " : ", ") + channels[i];
  return list + (channels.size() == 1 ? " tells" : " tell") +
         " how the sensor is moved: what goes with that may be rotation and stays in the rate; without a "
         "reference "
         "rate no error is traced there";
}

}  // namespace

std::vector<std::string> mark_own_rotation(BlockData& data) {
  std::vector<std::string> said, motion;
  if (data.reference >= 0 || data.grid.dwells) return said;
  const Eigen::VectorXd angle = angles_of(data.grid);
  for (std::size_t c = 0; c < data.channels.size(); ++c) {
    FineChannel& channel = data.channels[c];
    if (!channel.varies) continue;
    if (kind_of(channel.name) == ChannelKind::kAcceleration) {
      std::string words = look_at_acceleration(data, c, angle);
      channel.rotates = !words.empty();
      if (channel.rotates) said.push_back(std::move(words));
    } else if (kind_of(channel.name) == ChannelKind::kOther && tells_motion(channel.name)) {
      channel.rotates = true;
      motion.push_back(channel.name);
    }
  }
  if (!motion.empty()) said.push_back(motion_in_words(motion));
  return said;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/own_rotation.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "filters/effects/meaning.h"
#include "filters/linear/columns.h"
#include "filters/linear/projection.h"

namespace ifog {
namespace {

constexpr double kStandardGravity = 9.80665;  // m/s^2
constexpr Eigen::Index kFewestChanges = 50;   // changes of the angle that tell
constexpr std::size_t kLongestMean = 64;
// Twice the log-likelihood that the slope has to gain, the lengths tried and a swing's few independent
// periods included.
constexpr double kCertainSlope = 60.0;
// Of 1/g, the slope of a tilt about the sensor's own axis, which an accelerometer's noise makes smaller;
// above the second it is no tilt. And the angle's changes have to be a tilt's for the most part: what an
// acceleration does to a bias through a lag is in phase with its swing as well, a little.
constexpr double kLeastOfGravity = 0.03, kMostOfGravity = 2.0;
constexpr double kLeastCorrelation = 0.6;

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

// Changes from one mean over so many blocks to the next, of what lies within valid stretches of a record. A
// column each, as given.
Columns changes_of(const BlockGrid& grid, const Columns& columns, std::size_t blocks) {
  std::vector<Eigen::RowVectorXd> found;
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
      found.emplace_back(columns.middleRows(at + step, step).colwise().mean() -
                         columns.middleRows(at, step).colwise().mean());
      b += blocks;
    }
  }
  Columns changes(static_cast<Eigen::Index>(found.size()), columns.cols());
  for (std::size_t i = 0; i < found.size(); ++i) changes.row(static_cast<Eigen::Index>(i)) = found[i];
  return changes;
}

// Of the second column on the first, beside the others: what an accelerometer and a bias have in common
// through the temperature is no rotation.
RotationSlope rotation_slope(Columns changes) {
  const auto n = static_cast<double>(changes.rows());
  changes.rowwise() -= changes.colwise().mean().eval();
  Columns both = changes.leftCols(2);
  if (changes.cols() > 2) Projection(changes.rightCols(changes.cols() - 2)).take_out_of(both);
  const double xx = both.col(0).squaredNorm(), yy = both.col(1).squaredNorm();
  const double xy = both.col(0).dot(both.col(1));
  if (!(xx > 0.0) || !(yy > 0.0)) return {};
  RotationSlope slope{xy / xx, xy / std::sqrt(xx * yy), 0.0};
  slope.gain = -n * std::log(std::max(1e-12, 1.0 - slope.correlation * slope.correlation));
  return slope;
}

// Over the length at which it is clearest.
RotationSlope clearest_slope(const BlockGrid& grid, const Eigen::VectorXd& force,
                             const Eigen::VectorXd& follows, const Columns& temperatures) {
  Columns columns(force.size(), 2 + temperatures.cols());
  columns << force, follows, temperatures;
  RotationSlope best;
  for (std::size_t blocks = 1; blocks <= kLongestMean; blocks *= 2) {
    const Columns changes = changes_of(grid, columns, blocks);
    if (changes.rows() < kFewestChanges) break;
    const RotationSlope slope = rotation_slope(changes);
    if (slope.gain > best.gain) best = slope;
  }
  return best;
}

Columns temperatures_of(const BlockData& data) {
  std::vector<std::size_t> found;
  for (std::size_t c = 0; c < data.channels.size(); ++c)
    if (kind_of(data.channels[c].name) == ChannelKind::kTemperature && data.channels[c].varies)
      found.push_back(c);
  Columns columns(static_cast<Eigen::Index>(data.grid.size()), static_cast<Eigen::Index>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i)
    columns.col(static_cast<Eigen::Index>(i)) = column(data, ShapeSettings{}, found[i]);
  return columns;
}

// In the channel's unit.
double gravity_of(const std::string& channel) {
  const std::string unit = unit_of(channel);
  return unit == "g" ? 1.0 : unit == "mg" ? 1e3 : unit == "ug" ? 1e6 : kStandardGravity;
}

// A column's name may be of any length.
std::string tilt_in_words(const std::string& channel, const RotationSlope& slope, double gravity) {
  std::array<char, 64> figures{};
  std::snprintf(figures.data(), figures.size(), "%.2g of what gravity gives (correlation %.2f)",
                std::abs(slope.value) * gravity, std::abs(slope.correlation));
  return channel + " tells how the sensor itself tilts: the angle turned changes with it by " +
         figures.data() +
         ". That is rotation and stays in the rate; without a reference rate no error is traced to " +
         channel;
}

// One sentence where the acceleration is the sensor's own rotation; else empty.
std::string look_at_acceleration(const BlockData& data, std::size_t c, const Eigen::VectorXd& angle,
                                 const Columns& temperatures) {
  const std::string& name = data.channels[c].name;
  const Eigen::VectorXd force = column(data, ShapeSettings{}, c);
  const double gravity = gravity_of(name);
  const RotationSlope tilt = clearest_slope(data.grid, force, angle, temperatures);
  const double of_gravity = std::abs(tilt.value) * gravity;
  const bool tilts = tilt.gain > kCertainSlope && std::abs(tilt.correlation) >= kLeastCorrelation &&
                     of_gravity >= kLeastOfGravity && of_gravity <= kMostOfGravity;
  return tilts ? tilt_in_words(name, tilt, gravity) : "";
}

std::string motion_in_words(const std::vector<std::string>& channels) {
  std::string list;
  for (std::size_t i = 0; i < channels.size(); ++i)
    list += (i == 0 ? "" : i + 1 == channels.size() ? " and " : ", ") + channels[i];
  return list + (channels.size() == 1 ? " tells" : " tell") +
         " how the sensor is moved: what goes with that may be rotation and stays in the rate; without a "
         "reference rate no error is traced there";
}

}  // namespace

std::vector<std::string> mark_own_rotation(BlockData& data) {
  std::vector<std::string> said, motion;
  if (data.reference >= 0 || data.grid.dwells) return said;
  const Eigen::VectorXd angle = angles_of(data.grid);
  const Columns temperatures = temperatures_of(data);
  for (std::size_t c = 0; c < data.channels.size(); ++c) {
    FineChannel& channel = data.channels[c];
    if (!channel.varies) continue;
    if (kind_of(channel.name) == ChannelKind::kAcceleration) {
      std::string words = look_at_acceleration(data, c, angle, temperatures);
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

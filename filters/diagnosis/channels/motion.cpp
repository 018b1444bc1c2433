// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/channels/motion.h"

#include <cmath>

#include "filters/diagnosis/record/words.h"
#include "filters/effects/meaning.h"
#include "filters/series/finite_sum.h"

namespace ifog {
namespace {

// Means of this length keep a tenth of the variance of an acceleration that a sled or a tumble table holds.
// Traffic, sway, swell and the body waves of an earthquake are quicker.
constexpr double kHeld_s = 30.0;
constexpr double kHeldShare = 0.1;
// Towers, bridges, seas, suspensions and surface waves swing at 1 Hz and slower, machines shake quicker: means
// over this keep more than half of the power of the ones, and less of the others.
constexpr double kSwing_s = 0.5;
// Twice the log-likelihood that a slope has to gain: one in a million by chance, with a hundred looks.
constexpr double kCertainMotion = 40.0;
constexpr double kOfRate = 0.02;  // of the rate's variance, below which nothing is said
// Phase velocities of surface waves, from soft soil to the mantle, m/s.
constexpr double kSlowestWave = 80.0, kFastestWave = 8000.0;
// Share of gravity that an accelerometer shows in a tilt: less with noise of its own, more if it is off axis.
constexpr double kLeastOfTilt = 0.3, kMostOfTilt = 1.5;

struct Slope {
  double value = 0.0, share = 0.0, gain = 0.0;  // share: of y's variance; gain: twice the log-likelihood
};

// Slope of y over x, by their changes from block to block, so that slow drifts of either have no part in it.
Slope slope_of(const BlockGrid& grid, const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
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
  return {xy / xx, share, -n * std::log(std::max(1e-12, 1.0 - share))};
}

// By block, per second, over the two blocks before and behind.
Eigen::VectorXd change_of(const BlockGrid& grid, const Eigen::VectorXd& x) {
  Eigen::VectorXd change = Eigen::VectorXd::Zero(x.size());
  for (const BlockRange& record : grid.records)
    for (Eigen::Index k = record.row() + 1; k + 1 < record.row() + record.rows(); ++k)
      change[k] = (x[k + 1] - x[k - 1]) / (2.0 * grid.block_s);
  return change;
}

// m/s^2 for accelerations, m/s for velocities, and so on.
double si_of(const std::string& channel) {
  const std::string unit = unit_of(channel);
  if (unit == "g") return kStandardGravity;
  if (unit.starts_with("mg")) return 1e-3 * kStandardGravity;
  if (unit.starts_with("ug")) return 1e-6 * kStandardGravity;
  if (unit.starts_with("um")) return 1e-6;
  if (unit.starts_with("nm")) return 1e-9;
  return unit.starts_with("mm") ? 1e-3 : 1.0;
}

std::string as_wave(double slope) {  // rad/s per m/s^2: omega = a / 2c
  const double speed = 0.5 / std::abs(slope);
  return speed > kSlowestWave && speed < kFastestWave
             ? printed(", as ω = a/2c of a surface wave of c = %.3g m/s", speed)
             : "";
}

std::string reading_of(Motion motion, bool change, double slope) {
  if (motion == Motion::kAcceleration && change) {
    const double of_tilt = std::abs(slope) * kStandardGravity;
    if (of_tilt > kLeastOfTilt && of_tilt < kMostOfTilt)
      return printed(", as gravity's share in a tilt does (%.2g of it)", of_tilt);
  }
  if ((motion == Motion::kAcceleration && !change) || (motion == Motion::kVelocity && change))
    if (std::string wave = as_wave(slope); !wave.empty()) return wave;
  if (motion == Motion::kRate) return printed(", %.3g of it", std::abs(slope));
  if (motion == Motion::kAngle && change) return printed(", %.3g of its change", std::abs(slope));
  return ", as the sway or the ride of what the sensor stands on";
}

// One sentence of what the channel would explain; empty where that is nothing.
std::string rotation_in_words(const BlockData& data, std::size_t c, Motion motion) {
  const std::string& name = data.channels[c].name;
  const Eigen::VectorXd value = column(data, ShapeSettings{}, c) * si_of(name);
  const Slope by_value = slope_of(data.grid, value, data.grid.error);
  const Slope by_change = slope_of(data.grid, change_of(data.grid, value), data.grid.error);
  const bool change = by_change.gain > by_value.gain;
  const Slope& best = change ? by_change : by_value;
  if (best.gain < kCertainMotion || best.share < kOfRate) return "";
  return printed("%.0f %% of the changes of the rate go with the %s of ", 100.0 * best.share,
                 change ? "change" : "value") +
         name + reading_of(motion, change, best.value) + ": that is rotation and stays in the rate";
}

// The share of a channel's variance that means of so many samples keep. A long record's grid hides what is quick.
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
    if (std::string words = rotation_in_words(data, c, motion); !words.empty())
      said.push_back(std::move(words));
  }
  if (!names.empty())
    said.push_back(
        "without a reference rate nothing is traced to what senses motion (" + names +
        "), for it may be rotation: a capture with a reference rate would show which, or the "
        "same motion with the sensor's axis reversed (--allow-motion-channels treats it as error)");
  return said;
}

}  // namespace ifog

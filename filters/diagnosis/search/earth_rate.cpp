// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/earth_rate.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/channels/motion.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/effects/meaning.h"
#include "filters/units/field_units.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr double kEarth = 7.292115e-5;  // rad/s, WGS 84
constexpr double kWithin = 2.0;         // standard errors
constexpr double kOfGravity = 0.05;     // deviation from g of a resting triad: scale and mounting errors
constexpr double kSteady = 0.2;         // change of the total force relative to that of one component
constexpr double kUndone = 0.5;         // share of an acceleration's square that the others leave

double gravity_in(const std::string& channel) { return unit_of(channel) == "g" ? 1.0 : kStandardGravity; }

bool is_acceleration(const BlockData& data, std::size_t channel) {
  return channel != Candidate::kNone && kind_of(data.channels[channel].name) == ChannelKind::kAcceleration;
}

// Power of g that divides the effect's largest coefficient; 0 if it cannot be the Earth's rate.
int order_of(const BlockData& data, const Candidate& candidate) {
  if (!is_acceleration(data, candidate.channel)) return 0;
  if (candidate.form == Form::kLagged) return 1;
  if (candidate.form == Form::kProduct)
    return is_acceleration(data, candidate.with_channel) && candidate.with_form == Form::kLinear ? 2 : 0;
  return std::min(power_of(candidate.form), 3);
}

bool is_earth_rate(const BlockData& data, const EarthRateOptions& options, const Chosen& chosen) {
  const Candidate& candidate = chosen.candidate;
  const int order = order_of(data, candidate);
  if (order == 0) return false;
  const std::string& name = data.channels[candidate.channel].name;
  double most = order == 1 ? largest_earth_rate(name, options) : kEarth / gravity_in(name);
  for (int i = 1; i < order; ++i) most /= gravity_in(name);
  return std::abs(chosen.coefficient) - kWithin * chosen.std_error <= most &&
         may_be_tilt(data, candidate.channel);
}

}  // namespace

bool may_be_tilt(const BlockData& data, std::size_t channel) {
  const FineChannel& mine = data.channels[channel];
  const double g = gravity_in(mine.name);
  if (std::max(std::abs(mine.low), std::abs(mine.high)) > (1.0 + kOfGravity) * g) return false;
  const auto squares_of = [](const FineChannel& one) {
    const auto n = static_cast<Eigen::Index>(one.values.size());
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(one.values.data(), n).array().square());
  };
  Eigen::VectorXd own = squares_of(mine), all = Eigen::VectorXd::Zero(own.size());
  std::size_t count = 0;
  for (std::size_t c = 0; c < data.channels.size(); ++c) {
    const FineChannel& other = data.channels[c];
    if (!is_acceleration(data, c) || unit_of(other.name) != unit_of(mine.name)) continue;
    ++count;
    all += squares_of(other);
  }
  const double mean = all.mean();
  const bool all_of_gravity = std::abs(std::sqrt(mean) - g) < kOfGravity * g;
  if (!all_of_gravity) return count < 3;
  // The magnitude of the specific force must be constant; each axis is tested.
  all.array() -= mean;
  const double changes = all.squaredNorm() / (4.0 * mean);
  const double moves = variance_of(mine.values) * static_cast<double>(mine.values.size());
  if (count >= 3 && changes > kSteady * kSteady * moves) return false;
  own.array() -= own.mean();
  return own.dot(all) < kUndone * own.squaredNorm();
}

double largest_earth_rate(const std::string& channel, const EarthRateOptions& options) {
  const double most = kEarth / gravity_in(channel);
  if (!options.latitude_rad) return most;
  const double vertical = std::abs(std::sin(*options.latitude_rad));
  const double horizontal = std::cos(*options.latitude_rad);
  if (options.axis.empty()) return most * std::max(vertical, horizontal);
  return most * (channel.find("_" + options.axis + "_") != std::string::npos ? vertical : horizontal);
}

void read_as_earth_rate(const BlockData& data, const EarthRateOptions& options, SearchResult& found) {
  const FirstReading reading =
      options.subtract ? FirstReading::kEarthRateSubtracted : FirstReading::kEarthRateShown;
  for (Chosen& chosen : found.chosen)
    if (is_earth_rate(data, options, chosen)) chosen.candidate.first_reading = reading;
}

std::string earth_rate_in_words(const BlockData& data, const EarthRateOptions& options,
                                const SearchResult& found) {
  std::string words;
  for (const Chosen& each : found.chosen) {
    if (!each.candidate.is_earth_rate() || order_of(data, each.candidate) != 1) continue;
    const std::string& name = data.channels[each.candidate.channel].name;
    const double scale = gravity_in(name) / kDegreePerHour;
    words += (words.empty() ? "" : " and ") + formatted("%.3g °/h per g of ", each.coefficient * scale) +
             name + formatted(" (at most %.3g)", largest_earth_rate(name, options) * scale);
  }
  if (words.empty()) return "";
  return words + " is what the Earth's rate makes in a gyro that is turned or tilts: that is rotation, " +
         (options.subtract
              ? "subtracted as asked for with --earth; on another heading it is another"
              : "shown and not subtracted (--earth subtracts it). The same capture with the heading "
                "reversed would tell: g-sensitivity keeps its sign");
}

}  // namespace ifog

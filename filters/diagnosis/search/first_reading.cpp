// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/first_reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "filters/diagnosis/channels/motion.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/effects/meaning.h"
#include "filters/model_file/channel_names.h"
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

// True if the acceleration channel can be tilt: the magnitude of the triad stays at g, or, for a single
// accelerometer, it stays within g.
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

// Largest slope of a linear (or lagged) effect of this acceleration that the Earth's rate can cause, rad/s
// per unit of the channel.
double largest_earth_rate(const std::string& channel, const DiagnoseOptions& options) {
  const double most = kEarth / gravity_in(channel);
  if (!options.latitude_rad) return most;
  const double vertical = std::abs(std::sin(*options.latitude_rad));
  const double horizontal = std::cos(*options.latitude_rad);
  if (options.axis.empty()) return most * std::max(vertical, horizontal);
  return most * (channel.find("_" + options.axis + "_") != std::string::npos ? vertical : horizontal);
}

bool is_earth_rate(const BlockData& data, const DiagnoseOptions& options, const Chosen& chosen) {
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

void read_as_earth_rate(const BlockData& data, const DiagnoseOptions& options, SearchResult& found) {
  const FirstReading reading =
      options.subtract_earth_rate ? FirstReading::kEarthRateSubtracted : FirstReading::kEarthRateShown;
  for (Chosen& chosen : found.chosen)
    if (is_earth_rate(data, options, chosen)) chosen.candidate.first_reading = reading;
}

std::string earth_rate_in_words(const DiagnoseOptions& options, const BlockData& data,
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
         (options.subtract_earth_rate
              ? "subtracted as asked for with --earth; on another heading it is another"
              : "shown and not subtracted (--earth subtracts it). The same capture with the heading "
                "reversed would tell: g-sensitivity keeps its sign");
}

namespace {

// Grades by angle random walk, since a capture does not name the sensor. Largest values of data sheets: -
// ring lasers and fibre-optic gyros (KVH DSP-3000 and 1775, Fizoptika VG910, Optolink SRS):
//   1 °/h/g, 10 °/h/K, 60 °/h/V, 100 °/h/mT;
// - from 0.02 °/√h on also MEMS as quiet as a fibre-optic gyro (STIM300: 15 °/h/g; ADIS16488A: 0.009 °/s/g,
//   0.0025 °/s/K) or the Northrop LN-200;
// - MEMS (ADIS16405: 0.05 °/s/g, 0.01 °/s/K, 0.32 °/s/V; ADXRS, L3GD20, MPU-6050: 0.1 °/s/g, 0.3 °/s/K).
struct Grade {
  double noise;  // °/√h, upper limit
  const char* name;
  double per_g, per_kelvin, per_volt, per_millitesla;  // °/h
};
constexpr std::array<Grade, 3> kGrades = {{{0.02, "an optical gyro", 1.0, 10.0, 60.0, 100.0},
                                           {0.3, "a tactical gyro", 32.4, 10.0, 60.0, 100.0},
                                           {1e300, "a MEMS gyro", 360.0, 1080.0, 1152.0, 360.0}}};
// Data sheets describe shielded and compensated products; a gyro under development may be a decade worse.
constexpr double kMargin = 10.0;
// Most of a bias's RMS change without a reference rate, in multiples of the angle random walk (°/h per °/√h). Over the
// whole environment makers specify a span of some 60 for fibre-optic gyros (KVH 1750: 0.7 °/h with 0.012 °/√h), of
// 10³ for MEMS (ADIS16405: 0.01 °/s/K with 2 °/√h) and of up to 10⁴ for the cheapest (BMI270: 0.02 °/s/K with
// 0.42 °/√h, over 60 K). The RMS of a span that is used evenly is its part in √12. Blind sensors need 543.
constexpr double kMostOfWalk = 1e4 / (2.0 * std::numbers::sqrt3);
// m/s; no surface wave or vehicle is faster. So a rotation linked to an acceleration has a coefficient of at
// least 1/2c.
constexpr double kQuickest = 8000.0;

const Grade& grade_of(const BlockGrid& grid, const NoiseFit& noise) {
  const double density = std::sqrt(noise.white_variance * grid.block_s);
  std::size_t i = 0;
  while (density / kDegreePerRootHour > kGrades[i].noise) ++i;
  return kGrades[i];
}

// rad/s per unit of the channel; nullopt if nothing is specified.
std::optional<double> specified(const Grade& grade, const std::string& channel) {
  const std::string unit = unit_of(channel);
  const double scale = kMargin * kDegreePerHour;
  switch (kind_of(channel)) {
    case ChannelKind::kAcceleration:
      if (unit == "g") return scale * grade.per_g;
      return unit == "(m/s^2)" ? std::optional(scale * grade.per_g / kStandardGravity) : std::nullopt;
    case ChannelKind::kTemperature:
      return scale * grade.per_kelvin;
    case ChannelKind::kSupply:
      return unit == "V" ? std::optional(scale * grade.per_volt) : std::nullopt;
    case ChannelKind::kMagneticField:
      if (unit == "T") return scale * grade.per_millitesla * 1e3;
      if (unit == "G") return scale * grade.per_millitesla * 0.1;
      return unit == "uT" ? std::optional(scale * grade.per_millitesla * 1e-3) : std::nullopt;
    default:
      return std::nullopt;
  }
}

// The larger one of the fitted and that of neighbouring samples.
double most_of_walk(const BlockGrid& grid, const NoiseFit& noise) {
  const double per_second =
      std::max(noise.white_variance * grid.block_s, grid.white_variance * grid.sample_s);
  return kMostOfWalk * std::sqrt(per_second) / kDegreePerRootHour * kDegreePerHour;
}

struct Bound {
  double most;  // rad/s per unit of the channel
  const char* of;
};

// If an acceleration may come from a rotation, only a coefficient too small for that is an error.
std::optional<Bound> bound_of(const Grade& grade, const FineChannel& channel) {
  const std::optional<double> most = specified(grade, channel.name);
  if (!most) return std::nullopt;
  const double turned = 0.5 / kQuickest * (unit_of(channel.name) == "g" ? kStandardGravity : 1.0);
  return channel.moves && turned < *most ? Bound{turned, "what cannot be rotation"}
                                         : Bound{*most, grade.name};
}

double swing_of(const BlockGrid& grid, Eigen::VectorXd values) {
  centre_records(grid, values);
  return values.norm();
}

double size_of(const BlockData& data, const Chosen& effect) {
  const double channel = swing_of(data.grid, column(data, ShapeSettings{}, effect.candidate.channel));
  const double own = std::abs(effect.coefficient) * swing_of(data.grid, regressor(data, effect.candidate));
  return channel > 0.0 ? own / channel : 0.0;
}

// RMS of what the effects of a channel explain together, rad/s: a line and a power about 0 may be large and opposite.
double rms_of(const BlockData& data, const SearchResult& found, std::size_t channel) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data.grid.size()));
  for (const Chosen& each : found.chosen)
    if (each.candidate.channel == channel) sum += each.coefficient * regressor(data, each.candidate);
  return swing_of(data.grid, std::move(sum)) / std::sqrt(static_cast<double>(data.grid.used()));
}

// True if its effects are limited by the specification; some voltage is no supply.
bool is_specified(const std::string& channel) {
  switch (kind_of(channel)) {
    case ChannelKind::kTemperature:
    case ChannelKind::kAcceleration:
    case ChannelKind::kMagneticField:
    case ChannelKind::kRamp:
      return true;
    case ChannelKind::kSupply:
      return std::ranges::any_of(std::array{"supply", "batt", "vcc", "vdd", "vin", "bus", "rail", "power"},
                                 [&](const char* word) { return channel.find(word) != std::string::npos; });
    default:
      return false;
  }
}

// Rotation has no such limit.
bool more_than_a_bias(const BlockData& data, const SearchResult& found, const Candidate& of) {
  if (data.reference >= 0 || of.channel == Candidate::kNone || !carries_over(of.form)) return false;
  return !is_specified(data.channels[of.channel].name) &&
         rms_of(data, found, of.channel) > most_of_walk(data.grid, found.noise);
}

bool may_be_proxy(const BlockData& data, const Candidate& effect) {
  if (effect.channel == Candidate::kNone || effect.first_reading != FirstReading::kError) return false;
  if (!names_in(data.channels[effect.channel].name).less.empty()) return false;
  // Effects of the rate are scale factors; mean squares and derivatives have other units.
  return effect.form == Form::kLinear || effect.form == Form::kQuadratic || effect.form == Form::kCubic ||
         effect.form == Form::kLagged || effect.form == Form::kTransition;
}

}  // namespace

void doubt_proxies(const BlockData& data, SearchResult& found) {
  const Grade& grade = grade_of(data.grid, found.noise);
  for (Chosen& each : found.chosen) {
    bool doubted =
        each.candidate.first_reading == FirstReading::kError && more_than_a_bias(data, found, each.candidate);
    if (may_be_proxy(data, each.candidate)) {
      const std::optional<Bound> bound = bound_of(grade, data.channels[each.candidate.channel]);
      doubted |= bound && size_of(data, each) > bound->most;
    }
    if (doubted) each.candidate.first_reading = FirstReading::kProxyShown;
  }
}

std::string proxies_in_words(const BlockData& data, const SearchResult& found) {
  const Grade& grade = grade_of(data.grid, found.noise);
  std::string words;
  for (const Chosen& each : found.chosen) {
    if (each.candidate.first_reading != FirstReading::kProxyShown) continue;
    const FineChannel& channel = data.channels[each.candidate.channel];
    const std::optional<Bound> bound = bound_of(grade, channel);
    std::string mine = channel.name;
    if (bound && size_of(data, each) > bound->most)
      mine += formatted(" explains the bias by %.3g °/h per %s, %s has at most %.3g",
                        size_of(data, each) / kDegreePerHour, unit_of(channel.name).c_str(), bound->of,
                        bound->most / kDegreePerHour);
    else
      mine += formatted(" explains %.3g °/h, the bias of a gyro with this noise changes by at most %.3g",
                        rms_of(data, found, each.candidate.channel) / kDegreePerHour,
                        most_of_walk(data.grid, found.noise) / kDegreePerHour);
    if (words.find(mine) == std::string::npos) words += (words.empty() ? "" : "; ") + mine;
  }
  if (words.empty()) return words;
  return words +
         ": it stands for a rotation or for what was not logged, as a sensor that drifts like a thermometer "
         "does, and nothing is corrected by it (--allow-proxies does). Log the temperature and a reference "
         "rate";
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/candidates.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/channels/derived_channels.h"
#include "filters/effects/meaning.h"
#include "filters/model_file/channel_names.h"
#include "filters/units/field_units.h"

namespace ifog {
namespace {

constexpr double kGridFactor = 2.5;  // ratio of time constants; neighbours correlate above 0.95
// Shortest smoothing of a derivative, longer than a thermometer's steps
constexpr double kBlocksOfRate = 2.0;
// Shorter ones are start-up effects of the record.
constexpr double kShortestWarmUp_s = 10.0;
constexpr double kCentreInside =
    0.1;  // smallest distance of a transition's centre from the range's edge, as a share
// An axis was turned if its rate reaches this share of the own axis's, and is not a copy of it.
constexpr double kTurned = 0.05;
constexpr double kPicture = 0.9;

Candidate candidate_of(Form form, std::size_t channel, double tau = 0.0) {
  Candidate candidate;
  candidate.form = form;
  candidate.channel = channel;
  candidate.time_constant_s = tau;
  return candidate;
}

bool is_difference(const FineChannel& channel) { return !names_in(channel.name).less.empty(); }

Eigen::VectorXd means_of(const BlockData& data, std::size_t channel) {
  Eigen::VectorXd means = column(data, ShapeSettings{}, channel);
  centre_records(data.grid, means);
  return means;
}

// A gradient acts by its value, change or lag; not by powers or vibration.
void add_difference(const BlockData& data, std::size_t channel, std::vector<Candidate>& found) {
  found.push_back(candidate_of(Form::kLinear, channel));
  if (data.channels[channel].still) return;
  for (const Form form : {Form::kRate, Form::kLagged})
    for (const double tau : time_constants(data.grid, form))
      found.push_back(candidate_of(form, channel, tau));
}

// Once per turn (a field) and twice per turn (bending).
void add_angle(const BlockData& data, std::size_t channel, std::vector<Candidate>& found) {
  for (const double times : {1.0, 2.0}) {
    for (const Form form : {Form::kCosine, Form::kSine}) {
      found.push_back(candidate_of(form, channel));
      found.back().period = data.channels[channel].period / times;
    }
  }
}

void add_other_axis(const BlockData& data, std::size_t channel, std::vector<Candidate>& found) {
  if (data.reference < 0) return;
  const Eigen::VectorXd own = means_of(data, static_cast<std::size_t>(data.reference));
  const Eigen::VectorXd other = means_of(data, channel);
  if (other.norm() < kTurned * own.norm() || std::abs(own.dot(other)) > kPicture * own.norm() * other.norm())
    return;
  found.push_back(candidate_of(Form::kLinear, channel));
}

// The bias changes between two levels where the polarisation of the coil changes. Widths are shares of the
// range; the spacing of the centres is for correlations above 0.9.
void add_transitions(const BlockData& data, std::size_t channel, std::vector<Candidate>& found) {
  const FineChannel& source = data.channels[channel];
  if (kind_of(source.name) != ChannelKind::kTemperature) return;
  const double span = source.high - source.low;
  for (const double width : {0.07, 0.15, 0.32}) {
    const double room = 1.0 - 2.0 * kCentreInside;
    const double steps = std::ceil(room / (1.3 * width));
    for (double i = 0.0; i <= steps; i += 1.0) {
      Candidate candidate = candidate_of(Form::kTransition, channel);
      candidate.centre = source.low + span * (kCentreInside + room * i / steps);
      candidate.half_width = width * span;
      found.push_back(candidate);
    }
  }
}

// The square of a switch is the switch; what it heats follows with a lag.
void add_switch(const BlockData& data, std::size_t channel, std::vector<Candidate>& found) {
  found.push_back(candidate_of(Form::kLinear, channel));
  for (const double tau : time_constants(data.grid, Form::kLagged))
    found.push_back(candidate_of(Form::kLagged, channel, tau));
}

void add_vibration(const BlockData& data, std::size_t channel, std::vector<Candidate>& found) {
  const FineChannel& source = data.channels[channel];
  if (!source.vibrates() || source.period > 0.0) return;
  for (const double tau : time_constants(data.grid, Form::kBandPower))
    found.push_back(candidate_of(Form::kBandPower, channel, tau));
}

void add_channel(const BlockData& data, std::size_t channel, std::vector<Candidate>& found) {
  const auto add = [&](Form form, double tau) { found.push_back(candidate_of(form, channel, tau)); };
  const FineChannel& source = data.channels[channel];
  add(Form::kLinear, 0.0);
  // On a constant channel other forms are shapes of reading noise; a low-pass of it is like slow noise.
  if (!source.still) {
    for (const Form form : {Form::kQuadratic, Form::kCubic}) add(form, 0.0);
    add_transitions(data, channel, found);
    // The derivative of a horizontal acceleration is rotation times g, since tilt changes gravity's share.
    // Without a reference it cannot be distinguished. With one that moves it is the change of rotation, which
    // delay or interpolation of the reference turns into an error.
    const bool moved = data.reference < 0 || data.channels[static_cast<std::size_t>(data.reference)].varies;
    const bool is_rotation = moved && kind_of(source.name) == ChannelKind::kAcceleration;
    for (const Form form : {Form::kRate, Form::kLagged}) {
      if (is_rotation && (form != Form::kLagged || source.moves)) continue;
      for (const double tau : time_constants(data.grid, form)) add(form, tau);
    }
  }
  add_vibration(data, channel, found);
}

// The scale factor depends on the coil, whose temperature lags behind the thermometer. product: of the
// reference.
void add_lagging_scale(const BlockData& data, Candidate product, std::vector<Candidate>& found) {
  if (data.grid.dwells || kind_of(data.channels[product.with_channel].name) != ChannelKind::kTemperature)
    return;
  product.with_form = Form::kLagged;
  for (const double tau : time_constants(data.grid, Form::kLagged)) {
    product.time_constant_s = tau;
    found.push_back(product);
  }
}

void add_reference(const BlockData& data, std::vector<Candidate>& found) {
  const auto reference = static_cast<std::size_t>(data.reference);
  if (!data.channels[reference].varies) return;
  Candidate candidate;
  candidate.channel = reference;
  for (const Form form :
       {Form::kLinear, Form::kQuadratic, Form::kCubic, Form::kQuintic, Form::kSeptic, Form::kAbsolute}) {
    if (data.grid.noisy_reference && form != Form::kLinear) continue;
    candidate.form = form;
    found.push_back(candidate);
  }
  candidate.form = Form::kProduct;
  for (std::size_t channel = 0; channel < data.channels.size(); ++channel) {
    const FineChannel& source = data.channels[channel];
    if (channel == reference || !source.varies || !source.environment() || source.still) continue;
    if (is_difference(source)) continue;
    if (data.grid.noisy_reference && kind_of(source.name) != ChannelKind::kTemperature) continue;
    // Sensitivity of the scale factor, of its nonlinearity, and of its square.
    candidate.channel = channel;
    candidate.with_channel = reference;
    for (const Form form : {Form::kLinear, Form::kQuadratic, Form::kCubic}) {
      candidate.with_form = form;
      found.push_back(candidate);
    }
    candidate.channel = reference;
    candidate.with_channel = channel;
    candidate.with_form = Form::kQuadratic;
    found.push_back(candidate);
    add_lagging_scale(data, candidate, found);
  }
}

// Product of two environmental channels that are not copies of each other.
Candidate product_of(std::size_t one, std::size_t other) {
  Candidate candidate;
  candidate.form = Form::kProduct;
  candidate.channel = std::min(one, other);
  candidate.with_channel = std::max(one, other);
  return candidate;
}

bool may_be_factor(const BlockData& data, std::size_t channel) {
  const FineChannel& source = data.channels[channel];
  return static_cast<std::ptrdiff_t>(channel) != data.reference && source.varies && source.environment() &&
         !source.still && !is_difference(source);
}

// Effects of another channel while a switch is on.
std::vector<std::pair<std::size_t, std::size_t>> switched(const BlockData& data) {
  std::vector<std::pair<std::size_t, std::size_t>> found;
  for (std::size_t gate = 0; gate < data.channels.size(); ++gate) {
    if (!data.channels[gate].two_valued || !may_be_factor(data, gate)) continue;
    for (std::size_t other = 0; other < data.channels.size(); ++other)
      if (other != gate && may_be_factor(data, other)) found.emplace_back(gate, other);
  }
  return found;
}

// Sensitivities to another quantity that vary with temperature. If the temperature varies about the zero of
// the sensitivity, neither channel has an effect alone, and products_of() is never called.
void add_through_temperature(const BlockData& data, std::vector<Candidate>& found) {
  const auto warm = [&](std::size_t channel) {
    return kind_of(data.channels[channel].name) == ChannelKind::kTemperature;
  };
  for (std::size_t one = 0; one < data.channels.size(); ++one) {
    if (!may_be_factor(data, one) || !warm(one)) continue;
    for (std::size_t other = 0; other < data.channels.size(); ++other)
      if (may_be_factor(data, other) && !warm(other) && !data.channels[other].two_valued)
        found.push_back(product_of(one, other));
  }
}
}  // namespace

bool Candidate::same_shape(const Candidate& other) const {
  return form == other.form && channel == other.channel && with_form == other.with_form &&
         with_channel == other.with_channel && time_s == other.time_s && period == other.period;
}

bool has_shape(std::span<const Candidate> effects, const Candidate& wanted) {
  return std::ranges::any_of(effects, [&](const Candidate& each) { return each.same_shape(wanted); });
}

bool is_power_beyond(const BlockData& data, const Candidate& candidate) {
  if (power_of(candidate.form) < 2 || candidate.channel == Candidate::kNone) return false;
  const FineChannel& source = data.channels[candidate.channel];
  const double zero = reference_of(source.name);
  return zero < source.low || zero > source.high;
}

std::vector<double> time_constants(const BlockGrid& grid, Form form) {
  const double longest = static_cast<double>(grid.longest()) * grid.block_s;
  double from = grid.block_s * kBlocksOfRate;
  double to = std::min(kHour, longest / 3.0);
  if (form == Form::kLagged || form == Form::kWarmUp) from = std::max(from, 3.0 * grid.block_s);
  if (form == Form::kWarmUp) from = std::max(from, kShortestWarmUp_s);
  if (form == Form::kBandPower) {
    from = std::max(4.0 * grid.fine_s, 0.02);
    to = std::min(to, 100.0);
  }
  std::vector<double> times;
  const double factor = form == Form::kBandPower ? 10.0 : kGridFactor;
  double tau = from;
  while (tau <= to * 1.001) {
    times.push_back(tau);
    tau *= factor;
  }
  return times;
}

std::vector<Candidate> library(const BlockData& data) {
  std::vector<Candidate> found;
  for (std::size_t channel = 0; channel < data.channels.size(); ++channel) {
    if (static_cast<std::ptrdiff_t>(channel) == data.reference || !data.channels[channel].varies) continue;
    const FineChannel& source = data.channels[channel];
    if (source.moves && !source.held)
      add_vibration(data, channel, found);
    else if (data.reference >= 0 && source.period == 0.0 && motion_of(source.name) == Motion::kAngle)
      continue;  // part of a turn: the reference's rotation again
    else if (source.of_axis)
      add_other_axis(data, channel, found);
    else if (source.period > 0.0)
      add_angle(data, channel, found);
    else if (is_difference(source))
      add_difference(data, channel, found);
    else if (source.two_valued)
      add_switch(data, channel, found);
    else
      add_channel(data, channel, found);
  }
  for (const auto& [gate, other] : switched(data)) found.push_back(product_of(gate, other));
  add_through_temperature(data, found);
  if (data.reference >= 0) add_reference(data, found);
  if (data.grid.dwells) return found;
  Candidate of_time;
  of_time.form = Form::kRateRamp;
  found.push_back(of_time);
  of_time.form = Form::kWarmUp;
  for (double tau : time_constants(data.grid, Form::kWarmUp)) {
    of_time.time_constant_s = tau;
    found.push_back(of_time);
  }
  return found;
}

namespace {
// Scale factor with an unknown zero: at that value of the channel neither term is visible alone.
void add_scales(const BlockData& data, std::vector<NaturalPair>& pairs) {
  if (data.reference < 0) return;
  const auto reference = static_cast<std::size_t>(data.reference);
  for (std::size_t channel = 0; channel < data.channels.size(); ++channel) {
    if (!may_be_factor(data, channel)) continue;
    Candidate product = candidate_of(Form::kProduct, channel);
    product.with_channel = reference;
    pairs.push_back({candidate_of(Form::kLinear, reference), product});
  }
}
}  // namespace

std::vector<NaturalPair> natural_pairs(const BlockData& data) {
  std::vector<NaturalPair> pairs;
  if (data.grid.dwells) {
    // Nonlinearity at both ends of a rate table.
    if (data.reference >= 0) {
      const auto reference = static_cast<std::size_t>(data.reference);
      pairs.push_back({candidate_of(Form::kQuintic, reference), candidate_of(Form::kSeptic, reference)});
    }
    return pairs;
  }
  for (std::size_t channel = 0; channel < data.channels.size(); ++channel) {
    const FineChannel& source = data.channels[channel];
    std::vector<Candidate> swings;
    if (source.period > 0.0 && source.varies) add_angle(data, channel, swings);
    for (std::size_t i = 0; i + 1 < swings.size(); i += 2) pairs.push_back({swings[i], swings[i + 1]});
    if (!may_be_factor(data, channel) || source.two_valued) continue;
    pairs.push_back({candidate_of(Form::kLinear, channel), candidate_of(Form::kQuadratic, channel)});
  }
  for (const auto& [gate, other] : switched(data))
    pairs.push_back({candidate_of(Form::kLinear, gate), product_of(gate, other)});
  add_scales(data, pairs);
  return pairs;
}

std::vector<Candidate> products_of(const BlockData& data, std::size_t channel) {
  std::vector<Candidate> found;
  const bool of_axis = data.channels[channel].of_axis;
  if (!of_axis && !may_be_factor(data, channel)) return found;
  for (std::size_t other = 0; other < data.channels.size(); ++other)
    if (other != channel && may_be_factor(data, other)) found.push_back(product_of(channel, other));
  return found;
}

}  // namespace ifog

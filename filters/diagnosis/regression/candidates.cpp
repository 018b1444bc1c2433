#include "filters/diagnosis/regression/candidates.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filters/effects/meaning.h"

namespace ifog {
namespace {

constexpr double kHour = 3600.0;
constexpr double kGridFactor = 2.5;  // between time constants: neighbours correlate above 0.95
// A smooth channel's derivative needs smoothing over the quantisation of its thermometer, so it starts here.
constexpr double kBlocksOfRate = 2.0;
// What warms up has a mass. What settles faster is how the record began: a reference that came late, a hand
// that let go.
constexpr double kShortestWarmUp_s = 10.0;

ShapeSettings settings_of(const BlockData& data, Form form, std::size_t channel, double first,
                          double second) {
  ShapeSettings settings;
  settings.form = form;
  settings.reference = channel == Candidate::kNone ? 0.0 : reference_of(data.channels[channel].name);
  settings.time_constant_s = first;
  settings.second_time_constant_s = second;
  return settings;
}

void add_channel(const BlockData& data, std::size_t channel, std::vector<Candidate>& found) {
  const auto add = [&](Form form, double tau) {
    Candidate candidate;
    candidate.form = form;
    candidate.channel = channel;
    candidate.time_constant_s = tau;
    found.push_back(candidate);
  };
  const FineChannel& source = data.channels[channel];
  add(Form::kLinear, 0.0);
  // Of a channel that stands still the rest are pictures of reading noise, low-passed into a random walk that
  // slow noise will follow somewhere.
  if (!source.still) {
    for (const Form form : {Form::kQuadratic, Form::kCubic}) add(form, 0.0);
    // Gravity's share of a horizontal acceleration changes with the tilt, so its derivative is the rotation
    // itself (times g). Without a reference nothing tells the two apart, and a correction must be transparent
    // to rotation.
    const bool is_rotation = data.reference < 0 && kind_of(source.name) == ChannelKind::kAcceleration;
    for (const Form form : {Form::kRate, Form::kSecondRate, Form::kLagged}) {
      if (is_rotation && form != Form::kLagged) continue;
      for (const double tau : time_constants(data.grid, form)) add(form, tau);
    }
  }
  // Of a smooth one, what is above the low-pass is its slope.
  if (!source.smooth) {
    for (const double tau : time_constants(data.grid, Form::kBandPower)) add(Form::kBandPower, tau);
  }
}

void add_reference(const BlockData& data, std::vector<Candidate>& found) {
  const auto reference = static_cast<std::size_t>(data.reference);
  if (!data.channels[reference].varies) return;
  Candidate candidate;
  candidate.channel = reference;
  for (const Form form : {Form::kLinear, Form::kQuadratic, Form::kCubic, Form::kQuintic, Form::kSeptic}) {
    candidate.form = form;
    found.push_back(candidate);
  }
  candidate.form = Form::kProduct;
  for (std::size_t channel = 0; channel < data.channels.size(); ++channel) {
    const FineChannel& source = data.channels[channel];
    if (channel == reference || !source.varies || source.rotates || source.still) continue;
    // The channel's own scale factor sensitivity, its nonlinearity's, and its square's.
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
  }
}

}  // namespace

bool Candidate::same_shape(const Candidate& other) const {
  return form == other.form && channel == other.channel && with_form == other.with_form &&
         with_channel == other.with_channel && time_s == other.time_s && frequency_hz == other.frequency_hz;
}

std::vector<double> time_constants(const BlockGrid& grid, Form form) {
  const double longest = static_cast<double>(grid.longest()) * grid.block_s;
  double from = grid.block_s * kBlocksOfRate;
  double to = std::min(kHour, longest / 3.0);
  if (form == Form::kSecondRate) to = std::min(to, longest / 10.0);
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
    if (!data.channels[channel].rotates) add_channel(data, channel, found);
  }
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

std::vector<Candidate> products_of(const BlockData& data, std::size_t channel) {
  const auto usable = [&](std::size_t i) {
    const FineChannel& c = data.channels[i];
    return static_cast<std::ptrdiff_t>(i) != data.reference && c.varies && !c.rotates && !c.still;
  };
  std::vector<Candidate> found;
  if (!usable(channel)) return found;
  for (std::size_t other = 0; other < data.channels.size(); ++other) {
    if (other == channel || !usable(other)) continue;
    Candidate candidate;
    candidate.form = Form::kProduct;
    candidate.channel = std::min(channel, other);
    candidate.with_channel = std::max(channel, other);
    found.push_back(candidate);
  }
  return found;
}

Columns regressors(const BlockData& data, const Candidate& candidate) {
  const BlockGrid& grid = data.grid;
  const auto n = static_cast<Eigen::Index>(grid.size());
  if (candidate.channel != Candidate::kNone) {
    if (candidate.form == Form::kProduct) {
      return column(data, settings_of(data, Form::kLinear, candidate.channel, 0.0, 0.0), candidate.channel,
                    settings_of(data, candidate.with_form, candidate.with_channel, 0.0, 0.0),
                    candidate.with_channel);
    }
    return column(data,
                  settings_of(data, candidate.form, candidate.channel, candidate.time_constant_s,
                              candidate.second_time_constant_s),
                  candidate.channel);
  }
  Columns columns = Columns::Zero(n, candidate.width());
  for (std::size_t r = 0; r < grid.records.size(); ++r) {
    const double start = grid.time_s[grid.records[r].first];
    for (std::size_t b = grid.records[r].first; b < grid.records[r].end; ++b) {
      const auto row = static_cast<Eigen::Index>(b);
      const double t = grid.time_s[b] - start;
      switch (candidate.form) {
        case Form::kRateRamp:
          columns(row, 0) = t;
          break;
        case Form::kWarmUp:
          columns(row, 0) = std::exp(-t / candidate.time_constant_s);
          break;
        case Form::kStep:
          columns(row, 0) = r == candidate.record && grid.time_s[b] > candidate.time_s ? 1.0 : 0.0;
          break;
        default: {
          if (r != candidate.record) break;
          const double phase = 2.0 * std::numbers::pi * candidate.frequency_hz * grid.time_s[b];
          const double half = std::numbers::pi * candidate.frequency_hz * grid.block_s;
          const double kept = half < 1e-9 ? 1.0 : std::sin(half) / half;  // of a line, averaged over a block
          columns(row, 0) = kept * std::cos(phase);
          columns(row, 1) = kept * std::sin(phase);
        }
      }
    }
  }
  return columns;
}

double complexity(const Candidate& candidate) {
  switch (candidate.form) {
    case Form::kLinear:
      return 0.0;
    case Form::kQuadratic:
    case Form::kRateRamp:
      return 2.0;
    case Form::kSecondRate:
      return 20.0;  // with its bandwidth free it stands in for most things that change; rarely is it the
                    // thing
    case Form::kQuintic:
      return 5.0;
    case Form::kSeptic:
      return 6.0;
    case Form::kWarmUp:
      return 8.0;
    case Form::kProduct:  // a scale factor that depends on a channel, or its nonlinearity that does
      return candidate.with_form == Form::kLinear ? 4.0 : 8.0;
    default:
      return 4.0;
  }
}

Effect effect_of(const BlockData& data, const Candidate& candidate) {
  Effect effect;
  effect.form = name_of(candidate.form);
  if (candidate.channel != Candidate::kNone) {
    effect.channel = data.channels[candidate.channel].name;
    effect.reference = reference_of(effect.channel);
  }
  if (candidate.form == Form::kProduct) {
    effect.with_form = name_of(candidate.with_form);
    effect.with_channel = data.channels[candidate.with_channel].name;
    effect.with_reference = reference_of(effect.with_channel);
  }
  if (candidate.form == Form::kLine) {
    effect.parameters = {{"cosine", 0.0, 0.0, "rad/s"}, {"sine", 0.0, 0.0, "rad/s"}};
    effect.parameters.push_back({"frequency_hz", candidate.frequency_hz, 0.0, "Hz"});
  } else {
    effect.parameters = {{"coefficient", 0.0, 0.0, coefficient_unit(effect)}};
  }
  if (candidate.searched()) {
    effect.parameters.push_back(
        {std::string(time_constant_name(candidate.form)), candidate.time_constant_s, 0.0, "s"});
  }
  if (candidate.second_time_constant_s > 0.0) {
    effect.parameters.push_back({"second_lag_s", candidate.second_time_constant_s, 0.0, "s"});
  }
  if (candidate.form == Form::kStep) effect.parameters.push_back({"time_s", candidate.time_s, 0.0, "s"});
  effect.meaning = meaning_of(effect);
  return effect;
}

}  // namespace ifog

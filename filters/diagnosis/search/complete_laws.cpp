// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/complete_laws.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/search/fit_to_readings.h"
#include "filters/effects/meaning.h"
#include "filters/linear/normal_equations.h"

namespace ifog {
namespace {

// Twice the log-likelihood that a term has to gain where it may as well be missing. The channel is proven, so
// only this one is tried.
constexpr double kAsked = 7.0;
constexpr double kExpected = 0.0;  // it is there
// Of the size expected of once a turn: what bends twice a turn is the smaller part.
constexpr double kOfTwice = 0.5;
constexpr double kNothing = 1e-3;
// Twice the log-likelihood by which once a turn alone has to be likelier: where it was seen over so much of
// the circle that harmonics are told apart, and on a shorter arc, where twice a turn is most of the doubt.
constexpr double kDenied = 6.0;
constexpr double kDeniedOnArc = 2.0;

bool is_swing(const Candidate& each) { return each.form == Form::kCosine || each.form == Form::kSine; }

bool is_once(const Candidate& swing, double turn) { return swing.period > 0.75 * turn; }

struct Term {
  Candidate candidate;
  double least_gain;
  std::size_t of;  // the effect whose law it is part of
};

bool has(const std::vector<Candidate>& model, const Candidate& wanted) {
  return std::any_of(model.begin(), model.end(),
                     [&](const Candidate& each) { return each.same_shape(wanted); });
}

// The polynomial of a channel as it is now; none beside what would stand for the same.
bool alone_on_its_channel(const std::vector<Candidate>& model, const Candidate& effect) {
  return std::none_of(model.begin(), model.end(), [&](const Candidate& other) {
    return &other != &effect && other.uses(effect.channel) && other.form != Form::kProduct;
  });
}

std::optional<Term> missing_term(const BlockData& data, const std::vector<Candidate>& model, std::size_t i) {
  const Candidate& effect = model[i];
  if (effect.channel == Candidate::kNone || effect.first_reading != FirstReading::kError) return std::nullopt;
  const auto is_reference = [&](std::size_t channel) {
    return static_cast<std::ptrdiff_t>(channel) == data.reference;
  };
  const FineChannel& source = data.channels[effect.channel];
  Candidate term;
  term.form = Form::kLinear;
  term.channel = effect.channel;
  double least = kExpected;
  if (effect.form == Form::kProduct && effect.with_form == Form::kLinear) {
    const bool scale = is_reference(effect.channel) || is_reference(effect.with_channel);
    const bool gated = source.two_valued || data.channels[effect.with_channel].two_valued;
    if (!scale && !gated) return std::nullopt;
    const bool second = scale ? is_reference(effect.with_channel) : !source.two_valued;
    term.channel = second ? effect.with_channel : effect.channel;
    if (scale) least = kAsked;
  } else if (effect.form == Form::kLinear || effect.form == Form::kQuadratic) {
    if (is_reference(effect.channel) || !source.environment() || source.two_valued || source.still ||
        effect.of_channel > 0.0 || !alone_on_its_channel(model, effect))
      return std::nullopt;
    if (effect.form == Form::kLinear) term.form = Form::kQuadratic;
    const bool rests_at_zero = reference_of(source.name) == 0.0;
    if (effect.form == Form::kLinear || rests_at_zero) least = kAsked;
  } else {
    return std::nullopt;
  }
  if (has(model, term)) return std::nullopt;
  return Term{term, least, i};
}

// A law of an angle in a record: measurement and columns whitened, over the variance of the innovations.
struct Swing {
  Eigen::MatrixXd gram;
  std::vector<Eigen::Index> once, twice;  // of its columns, counted after the measurement's
  double size = 0.0;                      // in the record
};

Swing swing_of(const BlockData& data, const std::vector<Candidate>& model, std::size_t channel,
               const NoiseShape& shape) {
  const double turn = data.channels[channel].period;
  Columns white = design(data, model);
  const Eigen::VectorXd c = solve(data.grid, shape, white);
  Eigen::VectorXd part = Eigen::VectorXd::Zero(white.rows());
  Swing swing;
  for (std::size_t i = 0; i < model.size(); ++i) {
    if (!is_swing(model[i]) || model[i].channel != channel) continue;
    const Eigen::Index column = column_of(data.grid, model, i) - 1;
    (is_once(model[i], turn) ? swing.once : swing.twice).push_back(column);
    part += c[column] * white.col(1 + column);
  }
  centre_records(data.grid, part);
  swing.size = std::sqrt(2.0 * part.squaredNorm() / static_cast<double>(part.size()));
  Whitening(data.grid, shape).apply(white);
  swing.gram = white.transpose() * white;
  const double left = swing.gram(0, 0) - NormalEquations::of_measured_first(swing.gram).explained();
  swing.gram *= static_cast<double>(data.grid.used()) / std::max(left, 1e-300);
  return swing;
}

// Twice the logarithm of the marginal likelihood, constants left out, where the coefficients of once a turn
// are expected to be `size` and those of twice a turn that part of it.
double marginal(const Swing& swing, double size, double of_twice) {
  Eigen::MatrixXd known = swing.gram;
  double prior = 0.0;
  const auto expect = [&](const std::vector<Eigen::Index>& columns, double deviation) {
    for (const Eigen::Index j : columns) {
      known(1 + j, 1 + j) += 1.0 / (deviation * deviation);
      prior += 2.0 * std::log(deviation);
    }
  };
  expect(swing.once, size);
  expect(swing.twice, of_twice * size);
  const NormalEquations fit = NormalEquations::of_measured_first(known);
  return fit.explained() - fit.log_determinant() - prior;
}

struct Likeliest {
  double size = 0.0, value = -1e300;
};

Likeliest likeliest(const Swing& swing, double of_twice) {
  constexpr double kFarthest = 30.0, kFactor = 1.25;  // from the size in the record, up and down
  Likeliest best;
  for (double size = swing.size / kFarthest; size < kFarthest * swing.size; size *= kFactor) {
    const double value = marginal(swing, size, of_twice);
    if (value > best.value) best = {size, value};
  }
  return best;
}

// Cosine and sine of once and of twice a turn, whichever of them was found; twice a turn not where the record
// shows that there is nothing of it.
void complete_swing(const BlockData& data, std::size_t at, SearchResult& found) {
  const Candidate one = found.fitted[at];
  const double turn = data.channels[one.channel].period;
  const double p_value = found.chosen[at].p_value;
  bool twice_found = false;
  for (const Candidate& each : found.fitted) {
    if (!is_swing(each) || each.channel != one.channel) continue;
    twice_found |= !is_once(each, turn);
  }
  std::vector<Candidate> whole = found.fitted;
  for (const double period : {turn, 0.5 * turn})
    for (const Form form : {Form::kCosine, Form::kSine}) {
      Candidate term = one;
      term.form = form;
      term.period = period;
      if (!has(whole, term)) whole.push_back(term);
    }
  const Swing swing = swing_of(data, whole, one.channel, found.noise.shape);
  Likeliest expected = likeliest(swing, kOfTwice);
  const Likeliest once = likeliest(swing, kNothing);
  const double asked = harmonics_told_apart(data, one.channel) > 1 ? kDenied : kDeniedOnArc;
  const bool denied = !twice_found && expected.value < once.value - asked;
  if (denied) expected = once;
  std::vector<Candidate> kept;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const bool mine = is_swing(whole[i]) && whole[i].channel == one.channel;
    if (mine && denied && !is_once(whole[i], turn)) continue;
    if (mine) whole[i].expected = (is_once(whole[i], turn) ? 1.0 : kOfTwice) * expected.size;
    if (i >= found.fitted.size()) found.chosen.push_back({whole[i], 0.0, p_value});
    kept.push_back(whole[i]);
  }
  found.fitted = std::move(kept);
}

}  // namespace

bool complete_laws(const BlockData& data, const BlockData& reconstructed, SearchResult& found) {
  const BlockGrid& grid = reconstructed.grid;
  if (grid.dwells) return false;
  bool any = false;
  const std::size_t proven = found.fitted.size();
  for (std::size_t i = 0; i < proven; ++i) {
    const std::optional<Term> term = missing_term(reconstructed, found.fitted, i);
    if (!term) continue;
    std::vector<Candidate> model = found.fitted;
    model.push_back(term->candidate);
    const NoiseFit noise = fit_noise(grid, design(reconstructed, model), found.noise.shape);
    const double gain = 2.0 * (noise.log_likelihood - found.noise.log_likelihood);
    if (gain < term->least_gain) continue;
    found.chosen.push_back({term->candidate, gain, found.chosen[i].p_value});
    found.fitted = std::move(model);
    found.noise = noise;
    any = true;
  }
  for (std::size_t i = 0; i < proven; ++i) {
    const Candidate& each = found.fitted[i];
    if (!is_swing(each) || each.expected > 0.0 || each.first_reading == FirstReading::kEarthRateShown ||
        !(reconstructed.channels[each.channel].period > 0.0))
      continue;
    complete_swing(reconstructed, i, found);
    any = true;
  }
  if (!any) return false;
  for (std::size_t i = 0; i < found.chosen.size(); ++i) found.chosen[i].candidate = found.fitted[i];
  const Columns columns = design(reconstructed, found.fitted);
  found.noise = fit_noise(grid, columns, found.noise.shape);
  found.coefficients = solve(grid, found.noise.shape, columns, &found.covariance);
  found.fitted_coefficients = found.coefficients;
  fit_to_readings(data, reconstructed, found);
  return true;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/residual.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "filters/diagnosis/search/scan.h"
#include "filters/distributions/chi_squared.h"
#include "filters/model_file/channel_names.h"

namespace ifog {
namespace {

// Half widths of the play relative to the channel's range; neighbours correlate above 0.9.
constexpr std::array kShares = {0.05, 0.07, 0.1, 0.14, 0.19, 0.25, 0.33};
constexpr double kCertainLoop = 0.1;  // of the significance; strict, because a loop is not corrected

bool may_have_a_loop(const BlockData& data, std::size_t channel) {
  const FineChannel& c = data.channels[channel];
  return static_cast<std::ptrdiff_t>(channel) != data.reference && c.varies && c.smooth && !c.still &&
         c.environment() && names_in(c.name).less.empty();
}

// Most likely loop in place of the channel's effects; the noise fit starts at the model's.
std::pair<Hysteresis, NoiseFit> likeliest_loop(const BlockData& data, const std::vector<Candidate>& others,
                                               std::size_t channel, const NoiseShape& shape) {
  const FineChannel& source = data.channels[channel];
  const Columns base = design(data, others);
  Columns columns(base.rows(), base.cols() + 1);
  columns.leftCols(base.cols()) = base;
  Hysteresis loop;
  loop.channel = source.name;
  double most = -1e300;
  for (const double share : kShares) {
    const double width = share * (source.high - source.low);
    columns.rightCols(1) = hysteresis_loop(data, channel, width);
    const double value = fit_whitened(data.grid, shape, columns).log_likelihood();
    if (value > most) most = value, loop.half_width = width;
  }
  columns.rightCols(1) = hysteresis_loop(data, channel, loop.half_width);
  const NoiseFit best = fit_noise(data.grid, columns, shape);
  loop.coefficient = fit_whitened(data.grid, best.shape, columns).coefficients().tail(1)[0];
  return {loop, best};
}

}  // namespace

Eigen::VectorXd hysteresis_loop(const BlockData& data, std::size_t channel, double half_width) {
  const std::vector<double>& values = data.channels[channel].values;
  double play = 0.0;
  return block_means(data.grid, [&](std::size_t k, bool starts) {
    play = starts ? values[k] : std::clamp(play, values[k] - half_width, values[k] + half_width);
    return play - values[k];
  });
}

void take_out(const Hysteresis& loop, const BlockData& data, BlockGrid& grid) {
  const Eigen::VectorXd column = hysteresis_loop(data, *data.index_of(loop.channel), loop.half_width);
  for (std::size_t b = 0; b < grid.size(); ++b) {
    const auto row = static_cast<Eigen::Index>(b);
    if (grid.valid[b]) grid.error[row] -= loop.coefficient * column[row];
  }
}

std::optional<Hysteresis> find_hysteresis(const BlockData& data, const std::vector<Candidate>& model,
                                          const NoiseFit& noise, double significance) {
  std::optional<Hysteresis> found;
  const double tries = kProfiled * static_cast<double>(kShares.size() * data.channels.size());
  for (std::size_t c = 0; c < data.channels.size() && !data.grid.dwells; ++c) {
    if (!may_have_a_loop(data, c)) continue;
    std::vector<Candidate> others;
    std::ranges::copy_if(model, std::back_inserter(others), [&](const Candidate& each) {
      return each.channel != c || each.form == Form::kProduct;
    });
    Candidate linear;
    linear.channel = c;
    others.push_back(linear);
    auto [loop, with] = likeliest_loop(data, others, c, noise.shape);
    loop.likelihood_ratio = 2.0 * (with.log_likelihood - noise.log_likelihood);
    if (chi_squared_above(loop.likelihood_ratio, 2.0) * tries > kCertainLoop * significance) continue;
    if (!found || loop.likelihood_ratio > found->likelihood_ratio) found = loop;
  }
  return found;
}

}  // namespace ifog

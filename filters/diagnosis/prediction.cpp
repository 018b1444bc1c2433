#include "filters/diagnosis/prediction.h"

#include <cmath>

namespace ifog {
namespace {

// Variance that a first-order process with the given factor and drive, of white variance units, brings into
// sum of weight times value. A random walk (factor 1) starts anywhere: the weights sum to zero.
double brought_by(const std::vector<double>& weight, double factor, double drive) {
  double variance = 0.0;
  double ahead = 0.0;
  for (std::size_t k = weight.size(); k-- > 0;) {
    ahead = weight[k] + factor * ahead;
    const double start = k == 0 ? (factor < 1.0 ? drive / (1.0 - factor * factor) : 0.0) : drive;
    variance += start * ahead * ahead;
  }
  return variance;
}

}  // namespace

HeadingPrediction predict_heading(const BlockGrid& grid, const NoiseFit& noise, double aligned_s,
                                  const std::vector<double>& after_s) {
  HeadingPrediction prediction;
  prediction.aligned_s = aligned_s;
  const double step = grid.block_s;
  const auto aligned = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(aligned_s / step)));
  for (const double horizon : after_s) {
    const auto moving = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(horizon / step)));
    std::vector<double> weight(aligned + moving, step);
    for (std::size_t k = 0; k < aligned; ++k) {
      weight[k] = -step * static_cast<double>(moving) / static_cast<double>(aligned);
    }
    double variance = 0.0;
    for (const double w : weight) variance += w * w;
    const NoiseShape& shape = noise.shape;
    variance += brought_by(weight, 1.0, shape.walk);
    const auto markov = [&](double of, double blocks) {
      const double f = std::exp(-1.0 / blocks);
      variance += brought_by(weight, f, of * (1.0 - f * f));
    };
    if (shape.flicker > 0.0) {
      for (const double tau : flicker_bank(grid)) markov(shape.flicker, tau);
    }
    if (shape.markov > 0.0) markov(shape.markov, shape.markov_s / step);
    prediction.after_s.push_back(horizon);
    prediction.sigma_rad.push_back(std::sqrt(variance * noise.white_variance));
  }
  return prediction;
}

}  // namespace ifog

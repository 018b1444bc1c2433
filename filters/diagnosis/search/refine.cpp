#include "filters/diagnosis/search/refine.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Golden section in the logarithm of the time constant.
void refine(const BlockData& data, const NoiseShape& shape, std::vector<Candidate>& model, std::size_t at,
            double Candidate::*which) {
  Columns columns = design(data, model);
  const Eigen::Index place = column_of(data.grid, model, at);
  const auto value = [&](double log_tau) {
    Candidate trial = model[at];
    trial.*which = std::exp(log_tau);
    columns.col(place) = regressors(data, trial).col(0);
    return fit_whitened(data.grid, shape, columns).log_likelihood;
  };
  constexpr double kGolden = 0.6180339887498949;
  double low = std::log(model[at].*which / 2.5);
  double high = std::log(model[at].*which * 2.5);
  const double least = std::log(2.0 * data.grid.fine_s);
  low = std::max(low, least);
  const std::vector<double> tried = time_constants(data.grid, model[at].form);
  const double most = tried.empty() ? 3600.0 : std::min(3600.0, 1.6 * tried.back());
  high = std::min(std::max(high, least), std::log(most));
  low = std::min(low, high);
  double a = high - kGolden * (high - low);
  double b = low + kGolden * (high - low);
  double fa = value(a);
  double fb = value(b);
  while (high - low > 0.01) {
    if (fa > fb) {
      high = b;
      b = a;
      fb = fa;
      a = high - kGolden * (high - low);
      fa = value(a);
    } else {
      low = a;
      a = b;
      fa = fb;
      b = low + kGolden * (high - low);
      fb = value(b);
    }
  }
  model[at].*which = std::exp(0.5 * (low + high));
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "filters/distributions/chi_squared.h"

#include <boost/math/distributions/chi_squared.hpp>

namespace ifog {

double chi_squared_quantile(double p, double degrees) {
  return boost::math::quantile(boost::math::chi_squared(degrees), p);
}

double chi_squared_exceeded(double chance, double degrees) {
  return quantile(complement(boost::math::chi_squared(degrees), chance));
}

double chi_squared_above(double value, double degrees) {
  return value > 0.0 ? cdf(complement(boost::math::chi_squared(degrees), value)) : 1.0;
}

}  // namespace ifog

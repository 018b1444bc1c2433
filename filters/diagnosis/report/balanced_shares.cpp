// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/balanced_shares.h"

#include <algorithm>

namespace ifog {

void balance_shares(std::size_t jointly, Diagnosis& diagnosis) {
  const std::size_t count = std::min(jointly, diagnosis.effects.size());
  const double left = std::clamp(1.0 - diagnosis.unexplained.fraction, 0.0, 1.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += diagnosis.effects[i].variance_explained;
  if (sum <= left) return;
  for (std::size_t i = 0; i < count; ++i) diagnosis.effects[i].variance_explained *= left / sum;
}

}  // namespace ifog

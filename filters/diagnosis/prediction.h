// What the noise of a model does to the heading of a capture not yet made: exact for the linear functional
// "angle after alignment", from the same state space the diagnosis fits.
#pragma once

#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/noise_fit.h"

namespace ifog {

// bias taken over aligned_s, angle integrated from then to each of after_s.
HeadingPrediction predict_heading(const BlockGrid& grid, const NoiseFit& noise, double aligned_s,
                                  const std::vector<double>& after_s);

}  // namespace ifog

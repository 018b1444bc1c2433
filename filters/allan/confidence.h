// How far an overlapping Allan variance may be from the truth: χ² with equivalent degrees of freedom, which
// depend on the kind of noise at that averaging time (NIST SP 1065, sections 5.3.3 and 5.4, table 5).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/deviation.h"

namespace ifog {

// Power-law noise of the rate, S(f) ∝ f^α; the gyro names are those of IEEE Std 952.
enum class NoiseType : int {
  kQuantisation = 2,      // white phase noise, Q
  kFlickerPhase = 1,      // no IEEE 952 name
  kAngleRandomWalk = 0,   // white rate noise, N
  kBiasInstability = -1,  // flicker rate noise, B
  kRateRandomWalk = -2,   // K
};

// Lag-1 autocorrelation of averages over m samples, differenced until stationary (Riley and Greenhall, "Power
// law noise identification using the lag 1 autocorrelation", 18th EFTF, 2004). Uses the longest stretch;
// needs 30 averages there, or returns `otherwise`.
[[nodiscard]] NoiseType noise_type(const AngleSum& sum, std::size_t m, NoiseType otherwise);

// Equivalent degrees of freedom of the overlapping Allan variance at m of a record of `samples`, for 2m <=
// samples. At least 1 where a single difference fits.
[[nodiscard]] double allan_degrees_of_freedom(NoiseType type, std::size_t samples, std::size_t m);

// Value below which a χ² variable of `degrees` (> 0, need not be whole) stays with probability p; relative
// error 1e-10.
[[nodiscard]] double chi_squared_quantile(double p, double degrees);

struct AllanInterval {
  NoiseType type = NoiseType::kAngleRandomWalk;
  double degrees = 0.0;
  double lower_radps = 0.0, upper_radps = 0.0;  // of the deviation
};

// Intervals that hold the true deviation with probability `confidence`, one per point. With several stretches
// the degrees of freedom of each add up. m of the points ascending, so that the type of a τ too long to be
// identified is that of the τ before it.
[[nodiscard]] std::vector<AllanInterval> allan_intervals(const AngleSum& sum,
                                                         std::span<const DeviationPoint> points,
                                                         double confidence);

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/ramp_comb.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <unsupported/Eigen/FFT>

#include "filters/diagnosis/record/words.h"

namespace ifog {
namespace {

constexpr std::size_t kMostBins = 1U << 20U;
constexpr double kSlowSamples = 512.0;
constexpr double kLeastTurns = 20.0;
constexpr std::size_t kPeaks = 8;
constexpr std::size_t kMultiples = 8;  // a peak may be this harmonic
constexpr std::size_t kScored = 16;    // harmonics
constexpr double kStandsOut = 20.0;    // power over the noise around: once in 10^3 records by chance
constexpr std::size_t kRefined = 3;    // candidates
constexpr std::size_t kPieces = 512;
constexpr double kMostOfOne = 10.0;  // of a harmonic, in units of its cost: one loud line makes no comb
constexpr double kStanding = 0.3;    // of a carrier; through twenty cycles and more it turns to 0.05
constexpr std::size_t kFirst = 4;    // harmonics that begin the search for k
constexpr double kSeen = 25.0;       // twice the log-likelihood of a harmonic that says something of k
constexpr double kWorth = 4.0;       // of twice the log-likelihood, that two parameters cost on other data

using Complex = std::complex<double>;

// What harmonics of an angle's error explain of a rate, for k cycles a radian close to one given: the rate is
// summed against each harmonic over short pieces once, and another k costs the pieces only.
class HarmonicSums {
 public:
  // angle: in place of the part's. A harmonic h of the angle's error is cos and sin of 2 pi h k angle, of the
  // rate the differences of these over the step.
  HarmonicSums(const UnbrokenPart& part, const std::vector<double>& angle_rad, double cycles_per_rad,
               std::size_t harmonics);

  [[nodiscard]] std::size_t harmonics() const { return norm_.size(); }
  [[nodiscard]] std::size_t samples() const { return samples_; }
  [[nodiscard]] double square() const { return square_; }  // of the error, (rad/s)^2
  // Energy that cosine and sine of that harmonic, from 1, take out of the error; 0 of a
  // stroboscopic one.
  [[nodiscard]] double explained(std::size_t harmonic, double cycles_per_rad) const;
  // Length of the mean of its carrier, at the k given: 1 where the angle only ever takes values that are
  // whole cycles apart, as a sensor's does that counts pulses; near 0 where it turns through all of them.
  [[nodiscard]] double standing(std::size_t harmonic) const;

 private:
  double cycles_per_rad_;
  std::size_t samples_ = 0;
  double square_ = 0.0;
  std::vector<std::complex<double>> sums_;     // harmonic after harmonic
  std::vector<double> middle_rad_;             // of each piece
  std::vector<std::complex<double>> carrier_;  // mean
  std::vector<double> norm_;                   // energy of a harmonic of one radian
};

HarmonicSums::HarmonicSums(const UnbrokenPart& part, const std::vector<double>& angle_rad,
                           double cycles_per_rad, std::size_t harmonics)
    : cycles_per_rad_(cycles_per_rad),
      samples_(angle_rad.size()),
      sums_(harmonics * kPieces),
      middle_rad_(kPieces),
      carrier_(harmonics),
      norm_(harmonics) {
  for (std::size_t p = 0; p < kPieces; ++p) {
    const std::size_t from = 1 + p * (samples_ - 1) / kPieces;
    const std::size_t to = 1 + (p + 1) * (samples_ - 1) / kPieces;
    middle_rad_[p] = 0.5 * (angle_rad[from - 1] + angle_rad[to - 1]);
    for (std::size_t i = from; i < to; ++i) {
      const double error = part.error_radps[i];
      square_ += error * error;
      const Complex before = carrier_of(cycles_per_rad * angle_rad[i - 1]);
      const Complex now = carrier_of(cycles_per_rad * angle_rad[i]);
      Complex power_before = 1.0;
      Complex power_now = 1.0;
      for (std::size_t h = 0; h < harmonics; ++h) {
        power_before *= before;
        power_now *= now;
        const Complex rate = (power_now - power_before) / part.sample_s;
        sums_[h * kPieces + p] += error * std::conj(rate);
        norm_[h] += std::norm(rate);
        carrier_[h] += power_now / static_cast<double>(samples_);
      }
    }
  }
  for (std::size_t h = 0; h < harmonics; ++h)
    if (part.stroboscopic(cycles_per_rad, h + 1)) norm_[h] = 0.0;
}

double HarmonicSums::standing(std::size_t harmonic) const { return std::abs(carrier_[harmonic - 1]); }

double HarmonicSums::explained(std::size_t harmonic, double cycles_per_rad) const {
  const double off = static_cast<double>(harmonic) * (cycles_per_rad - cycles_per_rad_);
  Complex total = 0.0;
  const Complex* const sums = sums_.data() + (harmonic - 1) * kPieces;
  for (std::size_t p = 0; p < kPieces; ++p) total += sums[p] * carrier_of(-off * middle_rad_[p]);
  return norm_[harmonic - 1] > 0.0 ? 2.0 * std::norm(total) / norm_[harmonic - 1] : 0.0;
}

// Power over its neighbours' for k = bin / length, by the angle; length is twice the angle turned.
struct AngleSpectrum {
  std::vector<double> power;
  double length = 0.0;
};

void divide_by_floor(std::vector<double>& power) {
  constexpr std::size_t kBlock = 256;
  std::vector<double> floor;
  std::vector<double> window;
  for (std::size_t from = 0; from < power.size(); from += kBlock) {
    window.assign(power.begin() + static_cast<std::ptrdiff_t>(from),
                  power.begin() + static_cast<std::ptrdiff_t>(std::min(from + kBlock, power.size())));
    floor.push_back(std::max(median(window) / std::numbers::ln2, 1e-300));
  }
  for (std::size_t i = 0; i < power.size(); ++i) {
    const std::size_t block = i / kBlock;
    // The last block may be short, and where noise falls off steeply the louder neighbour counts.
    const double beside = std::max(floor[block], floor[std::min(block + 1, floor.size() - 1)]);
    power[i] /= beside;
  }
}

// A non-uniform transform: samples are put into bins of the angle, two or more to a cycle of the highest k.
AngleSpectrum spectrum_over(const std::vector<double>& angle, const std::vector<double>& error, double most) {
  const auto [low, high] = std::minmax_element(angle.begin(), angle.end());
  const double lowest = *low;
  AngleSpectrum out;
  out.length = 2.0 * (*high - lowest) * (1.0 + 1e-9);
  const double wanted = 2.0 * most * out.length;
  const std::size_t bins = std::min(kMostBins, std::bit_ceil(static_cast<std::size_t>(wanted) + 16));
  std::vector<double> sums(bins, 0.0);
  for (std::size_t i = 1; i < angle.size(); ++i) {
    const double position = (angle[i] - lowest) / out.length * static_cast<double>(bins);
    sums[std::min(static_cast<std::size_t>(position), bins - 1)] += error[i];
  }
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<std::complex<double>> transform;
  fft.fwd(transform, sums);
  const std::size_t last = std::min(transform.size(), static_cast<std::size_t>(most * out.length) + 1);
  out.power.resize(last);
  for (std::size_t i = 0; i < last; ++i) out.power[i] = std::norm(transform[i]);
  divide_by_floor(out.power);
  return out;
}

double around(const std::vector<double>& power, double bin) {
  const auto at = static_cast<std::size_t>(std::lround(bin));
  double most = 0.0;
  for (std::size_t i = at > 0 ? at - 1 : 0; i <= at + 1 && i < power.size(); ++i)
    most = std::max(most, power[i]);
  return most;
}

// What the harmonics of a fundamental at `bin` gain, less what they cost, for the best number of them.
double score_of(const std::vector<double>& power, double bin) {
  const double cost = std::log(static_cast<double>(power.size()));
  double best = 0.0;
  double sum = 0.0;
  for (std::size_t h = 1; h <= kScored; ++h) {
    const double place = bin * static_cast<double>(h);
    if (place >= static_cast<double>(power.size())) break;
    sum += std::min(around(power, place), kMostOfOne * cost) - cost;
    best = std::max(best, sum);
  }
  return best;
}

// Cycles a radian that the part can show: from a fundamental above the slow part that was taken out, with
// twenty cycles or more, to one below half the sample rate. Empty (least > most) near zero rate.
struct VisibleCycles {
  double least = 0.0, most = 0.0;
};

VisibleCycles visible_cycles(const UnbrokenPart& part) {
  const double turn = std::abs(part.mean_turn_rad());
  if (!(turn > 0.0)) return {1.0, 0.0};
  const double slowest = std::max(kLeastTurns / static_cast<double>(part.size()), 1.0 / kSlowSamples);
  return {std::max(kLeastCycles, slowest / turn), std::min(kMostCycles, 0.45 / turn)};
}

// Bins of fundamentals, the most telling first.
std::vector<double> fundamentals(const AngleSpectrum& spectrum, const VisibleCycles& visible) {
  const std::vector<double>& power = spectrum.power;
  std::vector<std::size_t> peaks;
  const auto first = static_cast<std::size_t>(visible.least * spectrum.length);
  for (std::size_t i = std::max<std::size_t>(1, first); i + 1 < power.size(); ++i) {
    if (power[i] > kStandsOut && power[i] >= power[i - 1] && power[i] > power[i + 1]) peaks.push_back(i);
  }
  std::sort(peaks.begin(), peaks.end(), [&](std::size_t a, std::size_t b) { return power[a] > power[b]; });
  if (peaks.size() > kPeaks) peaks.resize(kPeaks);
  std::vector<std::pair<double, double>> scored;
  for (const std::size_t peak : peaks) {
    for (std::size_t multiple = 1; multiple <= kMultiples; ++multiple) {
      const double bin = static_cast<double>(peak) / static_cast<double>(multiple);
      if (bin < visible.least * spectrum.length) break;
      scored.emplace_back(-score_of(power, bin), bin);
    }
  }
  std::sort(scored.begin(), scored.end());
  std::vector<double> bins;
  for (const auto& [score, bin] : scored) {
    const bool known = std::any_of(bins.begin(), bins.end(),
                                   [&, at = bin](double other) { return std::abs(other - at) < 1.0; });
    if (!known && bins.size() < kRefined) bins.push_back(bin);
  }
  return bins;
}

// The same of harmonics that were fitted to the samples.
double comb_score(const HarmonicSums& sums, double k, const RampComb& comb) {
  const double samples = static_cast<double>(sums.samples());
  const double cost = 2.0 * std::log(samples);
  const double left = sums.square() * samples / (samples + comb.ratio);
  double score = 0.0;
  for (std::size_t h = 1; h <= std::min(comb.harmonics, sums.harmonics()); ++h) {
    const double gain = sums.explained(h, k) * samples / left;
    score += std::min(gain, kMostOfOne * cost) - cost;
  }
  return score;
}

// The number of harmonics that gains most beyond kWorth each, and twice the log-likelihood it gains.
void count_harmonics(const HarmonicSums& sums, double k, RampComb& comb) {
  const double samples = static_cast<double>(sums.samples());
  double left = sums.square();
  std::vector<double> gains;
  for (std::size_t h = 1; h <= sums.harmonics(); ++h) gains.push_back(sums.explained(h, k));
  for (int round = 0; round < 2; ++round) {
    double sum = 0.0;
    double energy = 0.0;
    double best = 0.0;
    double explained = 0.0;
    for (std::size_t h = 0; h < gains.size(); ++h) {
      energy += gains[h];
      sum += gains[h] * samples / left - kWorth;
      if (sum <= best) continue;
      best = sum;
      explained = energy;
      comb.harmonics = h + 1;
    }
    left = std::max(sums.square() - explained, 1e-6 * sums.square());
    comb.ratio = explained * samples / left;
  }
}

// Of the first harmonics those that are seen at that k: noise would pull k about, the more so the higher.
std::vector<std::size_t> seen_at(const HarmonicSums& sums, std::size_t first, double k) {
  std::vector<std::size_t> seen;
  const double noise = sums.square() / static_cast<double>(sums.samples());
  for (std::size_t h = 1; h <= std::min(first, sums.harmonics()); ++h)
    if (sums.explained(h, k) > kSeen * noise) seen.push_back(h);
  return seen;
}

double best_in(const HarmonicSums& sums, const std::vector<std::size_t>& harmonics, double middle,
               double reach, double step) {
  double best = -1.0;
  double at = middle;
  for (double k = middle - reach; k <= middle + reach; k += step) {
    double power = 0.0;
    for (const std::size_t h : harmonics) power += sums.explained(h, k);
    if (power <= best) continue;
    best = power;
    at = k;
  }
  return at;
}

// k where the comb gathers most: first by few harmonics, which cannot miss it, then by ever more.
double refined(const HarmonicSums& sums, double k, double span) {
  double reach = 1.0 / span;
  std::vector<std::size_t> harmonics(kFirst);
  std::iota(harmonics.begin(), harmonics.end(), 1U);
  for (std::size_t most = kFirst; most < 2 * sums.harmonics(); most *= 2) {
    if (most > kFirst) {
      std::vector<std::size_t> seen = seen_at(sums, most, k);
      if (!seen.empty()) harmonics = std::move(seen);
    }
    const double step = 1.0 / (8.0 * static_cast<double>(harmonics.back()) * span);
    k = best_in(sums, harmonics, k, reach, step);
    reach = 2.0 * step;
  }
  for (int round = 0; round < 3; ++round) {
    k = best_in(sums, harmonics, k, reach, reach / 8.0);
    reach /= 4.0;
  }
  return k;
}

// Of the harmonics of k, each at the fixed frequency nearby that suits it best.
double gained_by_fixed(const UnbrokenPart& part, const RampComb& comb, double span) {
  const HarmonicSums sums(part, evenly_turned(part).angle_rad, comb.cycles_per_rad, comb.harmonics);
  double total = 0.0;
  for (std::size_t h = 1; h <= comb.harmonics; ++h) {
    const double bin = 1.0 / (static_cast<double>(h) * span);
    double best = 0.0;
    for (double off = -3.0; off <= 3.0; off += 0.25)
      best = std::max(best, sums.explained(h, comb.cycles_per_rad + off * bin));
    total += best;
  }
  return total;
}

// A sensor that counts pulses makes steps of a fixed angle: a comb over the angle, and no ramp.
bool counts_pulses(const HarmonicSums& sums) {
  for (std::size_t h = 1; h <= sums.harmonics(); ++h)
    if (sums.standing(h) > kStanding) return true;
  return false;
}

}  // namespace

std::optional<RampComb> find_ramp_comb(const UnbrokenPart& part) {
  const VisibleCycles visible = visible_cycles(part);
  if (part.size() == 0 || !(visible.least < visible.most)) return std::nullopt;
  const std::vector<double>& angle = part.angle_rad;
  const double top = 0.5 / std::abs(part.mean_turn_rad());
  const AngleSpectrum spectrum = spectrum_over(angle, part.error_radps, top);
  const double span = 0.5 * spectrum.length;
  std::optional<RampComb> best;
  double best_score = 0.0;
  for (const double bin : fundamentals(spectrum, visible)) {
    const double start = bin / spectrum.length;
    RampComb comb;
    comb.cycles_per_rad = refined(HarmonicSums(part, angle, start, kScored), start, span);
    const HarmonicSums few(part, angle, comb.cycles_per_rad, kScored);
    if (counts_pulses(few)) continue;
    count_harmonics(few, comb.cycles_per_rad, comb);
    const double score = comb_score(few, comb.cycles_per_rad, comb);
    if (comb.cycles_per_rad > visible.most || score <= best_score) continue;
    best_score = score;
    comb.tries = static_cast<double>(spectrum.power.size()) * kScored;
    best = comb;
  }
  if (!best) return best;
  const HarmonicSums all(part, angle, best->cycles_per_rad, kMostHarmonics);
  best->cycles_per_rad = refined(all, best->cycles_per_rad, span);
  count_harmonics(all, best->cycles_per_rad, *best);
  const double samples = static_cast<double>(part.size());
  const double explained = best->ratio * all.square() / (samples + best->ratio);
  best->over_fixed = (explained - gained_by_fixed(part, *best, span)) * samples / (all.square() - explained);
  return best;
}

}  // namespace ifog

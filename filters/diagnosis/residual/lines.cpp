// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/lines.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

#include "drivers/row_times/median.h"
#include "filters/diagnosis/residual/periodogram.h"
#include "filters/effects/meaning.h"
#include "filters/series/finite_sum.h"

namespace ifog {
namespace {

using Complex = std::complex<double>;

// Noise power next to a peak. On a resonance it is far above that of the wider band, so ripples of the
// resonance are not mistaken for lines.
double noise_near(std::span<const double> power, std::size_t k) {
  constexpr std::size_t kNear = 4;
  constexpr std::size_t kFar = 40;
  std::vector<double> window;
  for (std::size_t d = kNear; d <= kFar; ++d) {
    if (k > d) window.push_back(power[k - d]);
    if (k + d < power.size()) window.push_back(power[k + d]);
  }
  return median(window) / std::numbers::ln2;
}

Complex wave_at(double cycles) {
  return std::polar(1.0, -2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
}

// Sums of error exp(-i 2 pi f t) over equal pieces, so that the frequency can be refined with the sums. of:
// cycles per sample.
std::vector<Complex> demodulate(std::span<const double> error, double mean, double of, std::size_t pieces) {
  const Complex turn = wave_at(of);
  std::vector<Complex> sums(pieces);
  for (std::size_t p = 0; p < pieces; ++p) {
    const std::size_t from = p * error.size() / pieces, to = (p + 1) * error.size() / pieces;
    const Complex wave = wave_at(of * static_cast<double>(from));
    double cosine = wave.real(), sine = wave.imag(), real = 0.0, imaginary = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      const double value = std::isfinite(error[i]) ? error[i] - mean : 0.0;
      real += value * cosine;
      imaginary += value * sine;
      const double next = cosine * turn.real() - sine * turn.imag();
      sine = cosine * turn.imag() + sine * turn.real();
      cosine = next;
    }
    sums[p] = Complex(real, imaginary);
  }
  return sums;
}

Complex shifted(const std::vector<Complex>& sums, double cycles_per_piece, std::size_t from, std::size_t to) {
  Complex total(0.0, 0.0);
  for (std::size_t p = from; p < to; ++p) {
    total += sums[p] *
             std::polar(1.0, -2.0 * std::numbers::pi * cycles_per_piece * (static_cast<double>(p) + 0.5));
  }
  return total;
}

struct Search {
  std::span<const double> error;
  double start_s, period_s, significance;
  const Periodogram& spectrum;
};

// Offset from the bin, in units of 1 / length, with the largest coherent sum.
double best_offset(const std::vector<Complex>& sums) {
  const auto power_lacking = [&](double offset) {
    return -std::norm(shifted(sums, offset / static_cast<double>(sums.size()), 0, sums.size()));
  };
  constexpr int kBits = 14;  // 1e-4 of a bin
  std::uintmax_t most_evaluations = 50;
  return boost::math::tools::brent_find_minima(power_lacking, -1.0, 1.0, kBits, most_evaluations).first;
}

// If chance explains the peak, only the p-value is set.
SpectralLine refine(const Search& in, std::size_t bin, double floor) {
  const auto& [error, start_s, period_s, significance, spectrum] = in;
  const auto n = static_cast<double>(error.size()), length = static_cast<double>(spectrum.length);
  const double f0 = static_cast<double>(bin) / length, present = finite_sum(error).count;
  const std::vector<Complex> sums =
      demodulate(error, spectrum.mean, f0, std::min<std::size_t>(256, error.size() / 4));
  const auto pieces = static_cast<double>(sums.size());
  const double offset = best_offset(sums);
  const Complex total = shifted(sums, offset / pieces, 0, sums.size());

  SpectralLine line;
  line.frequency_hz = (f0 + offset / n) / period_s;
  line.ratio = std::norm(total) / (floor * present / length);
  // Between the bins there are more maxima than bins (Rice).
  const double between = std::max(1.0, std::sqrt(std::numbers::pi * line.ratio / 3.0));
  line.p_value = std::min(1.0, between * static_cast<double>(spectrum.power.size()) * std::exp(-line.ratio));
  if (line.p_value > significance) return line;
  double separate = 0.0;
  Complex together(0.0, 0.0);
  for (std::size_t q = 0; q < 4; ++q) {
    const Complex quarter = shifted(sums, offset / pieces, q * sums.size() / 4, (q + 1) * sums.size() / 4);
    separate += std::abs(quarter);
    together += quarter;
  }
  line.coherence = separate > 0.0 ? std::norm(together) / (separate * separate) : 0.0;
  const std::vector<Complex> whole = demodulate(error, spectrum.mean, line.frequency_hz * period_s, 1);
  const Complex amplitude =
      2.0 / present * whole[0] * std::polar(1.0, -2.0 * std::numbers::pi * line.frequency_hz * start_s);
  line.cosine = amplitude.real();
  line.sine = -amplitude.imag();
  line.std_error = std::sqrt(2.0 * floor / length / present);
  const double size = std::max(std::abs(amplitude), 1e-300);
  // Cramer-Rao bound of a tone's frequency in white noise (Rife and Boorstyn 1974).
  line.frequency_std_hz = std::sqrt(6.0) / std::numbers::pi * line.std_error / size / (n * period_s);
  return line;
}

// Fewest bins between two peaks.
std::size_t least_distance(std::size_t k) { return std::max<std::size_t>(6, k / 100); }

// peaks: strongest first.
std::vector<std::size_t> not_near(const std::vector<std::size_t>& peaks) {
  std::vector<std::size_t> taken;
  for (const std::size_t k : peaks)
    if (std::ranges::none_of(taken, [&](std::size_t t) { return are_one_peak(t, k); })) taken.push_back(k);
  return taken;
}

Samples samples_of(const SpectralLine& line, const EvenError& error, double sample_s) {
  const double turn = 2.0 * std::numbers::pi * line.frequency_hz;
  Samples part(error.rest->size());
  for (std::size_t i = 0; i < part.size(); ++i) {
    const double phase = turn * (error.start_s + static_cast<double>(i) * sample_s);
    part[i] = line.cosine * std::cos(phase) + line.sine * std::sin(phase);
  }
  return part;
}

FoundEffect effect_of(const SpectralLine& line, double total_variance) {
  FoundEffect found;
  Effect& effect = found.effect;
  effect.form = name_of(Form::kLine);
  effect.parameters = {{"cosine", line.cosine, line.std_error, "rad/s"},
                       {"sine", line.sine, line.std_error, "rad/s"},
                       {"frequency_hz", line.frequency_hz, line.frequency_std_hz, "Hz"}};
  effect.meaning = meaning_of(effect);
  found.p_value = line.p_value;
  found.likelihood_ratio = 2.0 * line.ratio;
  const double power = 0.5 * (line.cosine * line.cosine + line.sine * line.sine);
  found.variance_explained = total_variance > 0.0 ? std::min(1.0, power / total_variance) : 0.0;
  return found;
}

// True if the error itself is smaller without the line: an effect that does not hold leaves lines of its own.
bool is_in(std::span<const double> line, std::span<const double> error) {
  double gain = 0.0;
  for (std::size_t i = 0; i < line.size(); ++i)
    if (std::isfinite(error[i])) gain += line[i] * (2.0 * error[i] - line[i]);
  return gain > 0.0;
}

}  // namespace

bool are_one_peak(std::size_t one, std::size_t other) {
  return (one > other ? one - other : other - one) < least_distance(other);
}

std::vector<SpectralLine> find_lines(std::span<const double> error, double start_s, double period_s,
                                     double significance, std::size_t most) {
  std::vector<SpectralLine> lines;
  if (error.size() < 128) return lines;
  error = error.first(std::min(error.size(), kMostTransformed));
  const Periodogram spectrum = periodogram(error);
  const std::vector<double>& power = spectrum.power;
  const NoiseFloor floor(power);
  const Search in{error, start_s, period_s, significance, spectrum};
  for (const std::size_t k : not_near(peaks_of(spectrum, floor, significance))) {
    if (lines.size() >= most) break;
    const SpectralLine line = refine(in, k, std::max(floor[k], noise_near(power, k)));
    if (line.p_value <= significance) lines.push_back(line);
  }
  std::ranges::sort(lines, [](const SpectralLine& a, const SpectralLine& b) { return a.ratio > b.ratio; });
  return lines;
}

std::vector<FoundEffect> take_out_lines(double significance, BlockGrid& grid,
                                        std::vector<EvenError>& errors) {
  std::vector<FoundEffect> effects;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    EvenError& error = errors[r];
    for (const SpectralLine& line : find_lines(*error.after, error.start_s, grid.sample_s, significance)) {
      const Samples part = samples_of(line, error, grid.sample_s);
      if (line.coherence < kCoherent || !is_in(part, *error.before)) continue;
      take_out(part, r, grid, error);
      effects.push_back(effect_of(line, variance_of(*error.before)));
    }
  }
  return effects;
}

}  // namespace ifog

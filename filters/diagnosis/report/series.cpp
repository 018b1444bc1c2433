// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/report.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/allan/confidence.h"
#include "filters/allan/gapped_deviation.h"
#include "filters/diagnosis/residual/periodogram.h"
#include "filters/effects/meaning.h"
#include "filters/series/finite_sum.h"

namespace ifog {
namespace {

constexpr std::size_t kSeriesPoints = 4000;

// NaN if less than half of the block was measured.
double mean_of_block(const BlockGrid& grid, std::span<const double> error, std::size_t block) {
  const double samples = grid.block_s / grid.sample_s;
  const auto from =
      std::min(error.size(), static_cast<std::size_t>(std::lround(static_cast<double>(block) * samples)));
  const auto to =
      std::min(error.size(), static_cast<std::size_t>(std::lround(static_cast<double>(block + 1) * samples)));
  const auto [sum, n] = finite_sum(error.subspan(from, to - from));
  return 2.0 * n >= samples ? sum / n : std::numeric_limits<double>::quiet_NaN();
}

void add_allan_band(const EvenError& error, double sample_s, const NoiseTerms& noise,
                    std::span<const std::size_t> counts, DiagnosisSeries& series) {
  constexpr double kOneSigma = 0.6826894921370859;
  const auto squared = [](const std::optional<double>& value) { return value ? *value * *value : 0.0; };
  const TermVariances terms{squared(noise.Q) / (sample_s * sample_s), squared(noise.N) / sample_s,
                            squared(noise.B), squared(noise.K) * sample_s};
  const std::span<const double> left = *error.written;
  const AngleSum sum(left, stretches({}, left, {}));
  if (sum.parts().empty()) return;
  const std::vector<DeviationPoint> points = deviation(sum, counts, Deviation::kAllan);
  for (const AllanInterval& each : allan_intervals(sum, Deviation::kAllan, points, terms, kOneSigma)) {
    series.after_adev_low_radps.push_back(each.lower_radps);
    series.after_adev_high_radps.push_back(each.upper_radps);
  }
}

}  // namespace

DiagnosisSeries series_of(const BlockData& data, const std::vector<EvenError>& errors,
                          const std::vector<Chosen>& chosen, const std::vector<FoundEffect>& effects,
                          const std::vector<Eigen::VectorXd>& parts, const NoiseTerms& noise) {
  DiagnosisSeries series;
  const BlockGrid& grid = data.grid;
  const std::size_t stride = std::max<std::size_t>(1, grid.size() / kSeriesPoints);
  series.contribution_radps.resize(parts.size());
  series.channel.resize(parts.size());
  series.origin = grid.origin_of(0);
  for (std::size_t i = 0; i < parts.size(); ++i) series.names.push_back(name_of(effects[i].effect));
  for (std::size_t r = 0; r < grid.records.size(); ++r) {
    const BlockRange& record = grid.records[r];
    // The first record in its own time, each other one from the end of the one before, since their clocks may
    // be unrelated.
    const double offset =
        series.time_s.empty() || record.size() == 0
            ? 0.0
            : series.time_s.back() + static_cast<double>(stride) * grid.block_s - grid.time_s[record.first];
    for (std::size_t b = record.first; b < record.end; b += stride) {
      const auto row = static_cast<Eigen::Index>(b);
      series.time_s.push_back(offset + grid.time_s[b]);
      series.before_radps.push_back(mean_of_block(grid, *errors[r].before, b - record.first));
      series.after_radps.push_back(errors[r].written == errors[r].before
                                       ? series.before_radps.back()
                                       : mean_of_block(grid, *errors[r].written, b - record.first));
      for (std::size_t i = 0; i < parts.size(); ++i) {
        series.contribution_radps[i].push_back(parts[i][row]);
        const std::size_t channel = chosen[i].candidate.channel;
        if (channel != Candidate::kNone)
          series.channel[i].push_back(data.channels[channel].values[b * grid.fine]);
      }
    }
  }
  const EvenError& first = errors.front();
  const Spectrum before = averaged(periodogram(*first.before), grid.sample_s);
  const Spectrum after =
      first.written == first.before ? before : averaged(periodogram(*first.written), grid.sample_s);
  series.frequency_hz = before.frequency_hz;
  for (const double d : before.density) series.before_radps_rthz.push_back(std::sqrt(d));
  for (const double d : after.density) series.after_radps_rthz.push_back(std::sqrt(d));
  std::vector<std::size_t> counts;
  for (double m = 1.0; m * 4.0 < static_cast<double>(first.before->size()); m *= 1.5) {
    const auto count = static_cast<std::size_t>(m);
    const double tau = static_cast<double>(count) * grid.sample_s;
    if (!series.tau_s.empty() && tau <= series.tau_s.back()) continue;
    series.tau_s.push_back(tau);
    counts.push_back(count);
  }
  series.before_adev_radps = gapped_deviation(*first.before, counts);
  series.after_adev_radps =
      first.written == first.before ? series.before_adev_radps : gapped_deviation(*first.written, counts);
  add_allan_band(first, grid.sample_s, noise, counts, series);
  return series;
}

}  // namespace ifog

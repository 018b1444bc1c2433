// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/record_lines.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace ifog {
namespace {

constexpr std::size_t kMostSlowLines = 6;  // in one fit; the strongest come first

// Slow enough for block means to carry it; faster lines are fitted to the samples themselves.
bool is_slow(double frequency_hz, const BlockGrid& grid) { return frequency_hz * grid.block_s < 0.4; }

constexpr int kMostHarmonic = 8;
// Share of a channel's variance within one bin of its largest peak that makes it periodic.
constexpr double kPeriodic = 0.3;

// Frequency of a periodic series in cycles over its length, 0 when it has none. The peak may lie between the
// first few bins, where no spectrum would show a line.
double cycles_of(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double v : values) mean += v / n;
  double total = 0.0;
  for (const double v : values) total += (v - mean) * (v - mean);
  const auto share = [&](double cycles) {
    const std::complex<double> turn = std::polar(1.0, -2.0 * std::numbers::pi * cycles / n);
    std::complex<double> carrier = 1.0;
    std::complex<double> sum = 0.0;
    for (const double v : values) {
      sum += (v - mean) * carrier;
      carrier *= turn;
    }
    return 2.0 * std::norm(sum) / (n * std::max(total, 1e-300));
  };
  double best = 0.0;
  double most = kPeriodic;
  const auto last = static_cast<int>(std::min(1024.0, n));  // quarters of a cycle
  for (int quarters = 5; quarters < last; ++quarters) {
    const double cycles = 0.25 * quarters;
    const double value = share(cycles);
    if (value > most) {
      most = value;
      best = cycles;
    }
  }
  return best;
}

}  // namespace

void leave_out_periodic(const BlockData& data, Lines& lines) {
  if (lines.slow.empty() && lines.fast.empty()) return;
  const BlockGrid& grid = data.grid;
  for (std::size_t r = 0; r < grid.records.size(); ++r) {
    const std::size_t from = grid.fine_steps(grid.records[r]).first;
    const std::size_t steps = grid.fine_steps(grid.records[r]).size();
    const double span_s = static_cast<double>(steps) * grid.fine_s;
    for (const FineChannel& channel : data.channels) {
      if (!channel.varies) continue;
      // A few thousand means keep every period that counts here.
      const std::size_t stride = std::max<std::size_t>(1, steps / 2048);
      std::vector<double> means;
      for (std::size_t k = 0; k + stride <= steps; k += stride) {
        double sum = 0.0;
        for (std::size_t i = 0; i < stride; ++i) sum += channel.values[from + k + i];
        means.push_back(sum / static_cast<double>(stride));
      }
      const double cycles = cycles_of(means);
      if (cycles <= 0.0) continue;
      const auto harmonic = [&](double frequency_hz) {
        const double times = frequency_hz * span_s / cycles;
        const double nearest = std::round(times);
        return nearest >= 1.0 && nearest <= kMostHarmonic &&
               std::abs(times - nearest) * cycles < 0.5 + 0.25 * nearest;
      };
      std::erase_if(lines.slow,
                    [&](const Candidate& line) { return line.record == r && harmonic(line.frequency_hz); });
      std::erase_if(lines.fast, [&](const FastLine& line) {
        return line.record == r && harmonic(line.line.frequency_hz);
      });
    }
  }
}

Lines coherent_lines(const std::vector<EvenError>& errors, const BlockGrid& grid, double significance,
                     KnownPeriodograms& known) {
  Lines found;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    for (const SpectralLine& line :
         find_lines(errors[r].after, errors[r].start_s, grid.sample_s, significance, known)) {
      if (line.coherence < kCoherent) continue;
      if (is_slow(line.frequency_hz, grid)) {
        if (found.slow.size() >= kMostSlowLines) continue;
        Candidate candidate;
        candidate.form = Form::kLine;
        candidate.record = r;
        candidate.frequency_hz = line.frequency_hz;
        found.slow.push_back(candidate);
      } else {
        found.fast.push_back({r, line});
      }
    }
  }
  return found;
}

void keep_proven(const SearchResult& found, std::size_t samples, double significance, Lines& lines) {
  const double tries = 0.5 * static_cast<double>(samples);
  std::vector<Candidate> kept;
  for (std::size_t i = 0; i < lines.slow.size(); ++i) {
    if (tries * std::exp(-0.5 * found.chosen[i].likelihood_ratio) < significance)
      kept.push_back(lines.slow[i]);
  }
  lines.slow = std::move(kept);
}

void take_out(const std::vector<FastLine>& lines, double sample_s, std::vector<EvenError>& errors) {
  for (const FastLine& fast : lines) {
    EvenError& error = errors[fast.record];
    Samples& rest = error.rest.own();
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const double phase =
          2.0 * M_PI * fast.line.frequency_hz * (error.start_s + static_cast<double>(i) * sample_s);
      rest[i] -= fast.line.cosine * std::cos(phase) + fast.line.sine * std::sin(phase);
    }
  }
}

}  // namespace ifog

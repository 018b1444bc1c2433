#include "filters/diagnosis/record_lines.h"

#include <algorithm>

#include "filters/effects/meaning.h"

namespace ifog {
namespace {

constexpr std::size_t kMostSlowLines = 6;  // in one fit; the strongest come first

// Slow enough for block means to carry it; faster lines are fitted to the samples themselves.
bool is_slow(double frequency_hz, const BlockGrid& grid) { return frequency_hz * grid.block_s < 0.4; }

}  // namespace

Lines coherent_lines(const std::vector<EvenError>& errors, const BlockGrid& grid, double significance) {
  Lines found;
  for (std::size_t r = 0; r < errors.size(); ++r) {
    for (const SpectralLine& line :
         find_lines(errors[r].after, errors[r].start_s, grid.sample_s, significance)) {
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

FoundEffect line_effect(const SpectralLine& line, double total_variance) {
  FoundEffect found;
  Effect& effect = found.effect;
  effect.form = "line";
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

}  // namespace ifog

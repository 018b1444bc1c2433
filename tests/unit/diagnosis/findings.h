// SPDX-License-Identifier: Apache-2.0
// What a diagnosis found: its effects looked up and in words, and that a correction leaves rotation as it is.
#pragma once

#include "filters/diagnosis/diagnose.h"
#include "filters/units/field_units.h"
#include "tests/unit/test.h"

namespace ifog {

// nullptr: none of that form was found, of any channel or of this one.
inline const Effect* effect_of(const Diagnosis& diagnosis, std::string_view form) {
  for (const FoundEffect& found : diagnosis.effects)
    if (found.effect.form == form) return &found.effect;
  return nullptr;
}

inline const Effect* effect_of(const Diagnosis& diagnosis, std::string_view form, std::string_view channel) {
  for (const FoundEffect& found : diagnosis.effects)
    if (found.effect.form == form && found.effect.channel == channel) return &found.effect;
  return nullptr;
}

inline std::string all_in_words(const Diagnosis& diagnosis) {
  std::string words;
  for (const FoundEffect& found : diagnosis.effects)
    words += found.effect.form + " of " + found.effect.channel + "; ";
  return words;
}

// Rotation that is added keeps its size within 2 % and its phase within 2 degrees, from a tenth of a hertz to 0.8
// of half the sample rate, about each of these mean rates. compensated: of a record at step_s, with a rotation (rad/s
// by sample) added to it, or with none.
template <class Compensated>
void expect_transparent(Compensated&& compensated, double step_s, std::initializer_list<double> mean_rates) {
  const std::vector<double> still = compensated(nullptr);
  double worst_gain = 0.0, worst_phase = 0.0;
  for (const double mean : mean_rates) {
    for (const double frequency : {0.1, 1.0, 5.0, 20.0, 50.0, 80.0}) {
      const double amplitude = 2e-5, turn = 2.0 * M_PI * frequency * step_s;
      std::vector<double> rotation(still.size());
      for (std::size_t i = 0; i < rotation.size(); ++i)
        rotation[i] = mean + amplitude * std::sin(turn * static_cast<double>(i));
      const std::vector<double> turning = compensated(&rotation);
      std::complex<double> in = 0.0, out = 0.0;
      for (std::size_t i = 0; i < rotation.size(); ++i) {
        const std::complex<double> carrier = std::polar(1.0, -turn * static_cast<double>(i));
        in += (rotation[i] - mean) * carrier;
        out += (turning[i] - still[i] - mean) * carrier;
      }
      EXPECT_NEAR(std::abs(out / in), 1.0, 0.02) << mean << " rad/s, " << frequency << " Hz";
      EXPECT_NEAR(std::arg(out / in), 0.0, 2.0 * kDegree) << mean << " rad/s, " << frequency << " Hz";
      worst_gain = std::max(worst_gain, std::abs(std::abs(out / in) - 1.0));
      worst_phase = std::max(worst_phase, std::abs(std::arg(out / in)));
    }
  }
  std::printf("gain within %.3f %%, phase within %.3f degrees\n", 100.0 * worst_gain, worst_phase / kDegree);
}

}  // namespace ifog

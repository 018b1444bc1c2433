// SPDX-License-Identifier: Apache-2.0
// Names of channels, effects and figures for people.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/model_file/model.h"

namespace ifog::report {

std::string channel_label(const std::string& column);  // "temperature (°C)"
std::string channel_words(const std::string& column);  // "temperature"
std::string abscissa_label(const Effect& effect);      // label of the effect's abscissa
std::string effect_words(const Effect& effect);        // "quadratic in temperature", "line at 3.31 Hz"

// Parameters for people: a line by amplitude and phase of amplitude * cos(2 pi f t - phase). The amplitude's
// error is from the likelihood, because the errors of cosine and sine contain that of the frequency, which
// only changes the phase.
std::vector<ModelParameter> shown_parameters(const FoundEffect& found);

// A figure in `before` and `after`: its label and its value in the field's unit, from the key's suffix.
struct Figure {
  std::string label, unit;
  double scale;  // factor from the SI value
};
Figure figure(const std::string& key);

// "rad/s/degC": factor to °/h and the name "°/h/°C".
struct FieldUnit {
  double scale;
  std::string unit;
};
FieldUnit field_unit(const std::string& si);

}  // namespace ifog::report

// SPDX-License-Identifier: Apache-2.0
// Names of channels, effects and figures for people, and the findings in plain language.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"
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

// "time constant" for "time_constant_s": without the unit, which has its own place.
std::string parameter_words(std::string name);

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

std::string account(const Diagnosis& diagnosis);          // HTML paragraphs
std::string account_of_rest(const Diagnosis& diagnosis);  // the unexplained part; HTML
// "falls from 1.2 °/h to 0.4 °/h": plain text.
std::string account_of_change(const Diagnosis& diagnosis, const std::string& key);

// Keys of before/after in reading order: single samples, then means by increasing length.
std::vector<std::string> in_reading_order(const std::map<std::string, double>& figures);

// True if effects cancel each other: then their shares of the error do not add up to one, which page and
// console note.
bool parts_overlap(const Diagnosis& diagnosis);

std::string sentence(const std::string& text);  // first letter in upper case, full stop at the end
std::string probability(double p);              // "0.003", "below 1 in a million"

}  // namespace ifog::report

// SPDX-License-Identifier: Apache-2.0
// The model of one sensor: its noise, its filter, its effects, the range they were fitted on, and where all
// that came from. Written by `ifog tune` and `ifog diagnose`, read by ifogd, `ifog denoise` and `ifog
// diagnose`.
//
// The file is TOML. Version rule: `version` is the first key; a reader accepts exactly the versions it knows
// and says so otherwise. Unknown keys are errors.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "filters/settings/filter_settings.h"

namespace ifog {

struct ModelParameter {
  std::string name;  // "coefficient", "lag_s", "frequency_hz", "bandwidth_s", …
  double value = 0.0;
  double std_error = 0.0;
  std::string unit;
};

// A form applied to a channel; for "product" also `with_form` of `with_channel`. A channel may be the
// difference of two columns, "A - B": in the file channel = "A", minus_channel = "B" (likewise
// with_minus_channel).
struct Effect {
  std::string form;
  std::string channel;  // the capture's column name; "" for forms without one
  std::string with_form, with_channel;
  std::string axis;        // "" for a single-axis sensor
  double reference = 0.0;  // the channel's value at which the effect is zero (25 degC, 12 V, 0 elsewhere)
  double with_reference = 0.0;  // "product": likewise of with_channel
  std::vector<ModelParameter> parameters;
  std::vector<double> table_x, table_y;  // "lookup": knots in the channel's unit, values in rad/s
  double period =
      0.0;  // "lookup": > 0 when periodic; "cosine", "sine": of the channel, an angle or a temperature
  // "lookup": the table is an angle in rad and the effect its difference from sample to sample over dt. A
  // bounded angle cannot swallow rotation, so this is the only kind allowed on channels that themselves
  // follow the rate.
  bool angle = false;
  // The Earth's rate by its first reading, which is rotation and no error: a diagnosis shows it; it is
  // neither corrected nor written to a file.
  bool shown_only = false;
  std::string meaning;
  std::uint32_t line = 0;  // in the file that it was read from; 0: of none
};

struct ChannelRange {
  std::string channel;  // or the difference of two, as in an effect
  double low = 0.0, high = 0.0;
  double early_s = 0.0;  // what it says acts so much later: logged early, or on a way of its own
  bool fades =
      false;  // of a channel that senses motion, whose correction ends beyond the range; not in files
};

inline constexpr double kMostEarly_s = 60.0;

// IEEE Std 952 coefficients, SI: Q rad, N rad/s/sqrt(Hz), B rad/s, K rad/s^2/sqrt(Hz), R rad/s^2; absent: not
// seen.
struct NoiseTerms {
  std::optional<double> Q{}, N{}, B{}, K{}, R{};
};

struct ModelSource {
  std::string capture, sha256, date;            // what it was fitted on
  std::map<std::string, double> before, after;  // held-out figures of the diagnosis
};

struct Model {
  static constexpr int kVersion = 1;
  std::string sensor;
  std::map<std::string, NoiseTerms> noise;  // by axis
  std::optional<FilterSettings> filter;     // from `ifog tune`
  std::vector<Effect> effects;
  // Covariance of all effect parameters in order, row-major, SI; empty if unknown. A file has the rows of effects
  // that are corrected online; files of older versions have all rows.
  std::vector<double> covariance;
  std::vector<ChannelRange> ranges;
  ModelSource source;

  // Short and stable: the first 12 hex digits of the SHA-256 of the file's text as written.
  [[nodiscard]] std::string identity() const;
};

// Both throw std::runtime_error with one line: file, line or key, value, what was expected.
Model read_model(const std::string& path);
Model parse_model(std::string_view text, const std::string& name);  // `name` stands for the file in messages
// The file's text; who writes it is the caller's choice.
std::string model_text(const Model& model);

}  // namespace ifog

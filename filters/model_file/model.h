// SPDX-License-Identifier: Apache-2.0
// Model of one sensor: noise, filter, effects, their fitted ranges, and the source. Written by `ifog tune`
// and `ifog diagnose`, read by ifogd, `ifog denoise` and `ifog diagnose`.
//
// The file is TOML. `version` is the first key; a reader accepts exactly the versions it knows. Unknown keys
// are errors.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "filters/settings/filter_settings.h"

namespace ifog {

struct ModelParameter {
  std::string name;  // "coefficient", "lag_s", "frequency_hz", "bandwidth_s", …
  double value = 0.0;
  double std_error = 0.0;
  std::string unit;
};

// A form applied to a channel; "product" also has `with_form` of `with_channel`. A channel may be the
// difference of two columns, "A - B": in the file channel = "A", minus_channel = "B" (or with_minus_channel).
struct Effect {
  std::string form;
  std::string channel;  // column of the capture; "" for forms without one
  std::string with_form, with_channel;
  std::string axis;             // "" for a single-axis sensor
  double reference = 0.0;       // channel value at which the effect is zero (25 degC, 12 V, else 0)
  double with_reference = 0.0;  // "product": the same for with_channel
  std::vector<ModelParameter> parameters;
  std::vector<double> table_x, table_y;  // "lookup": knots in the channel's unit, values in rad/s
  double period =
      0.0;  // "lookup": > 0 if periodic; "cosine", "sine": of the channel, an angle or temperature
  // "lookup": the table is an angle in rad and the effect its difference between samples / dt. A bounded
  // angle cannot remove rotation, so channels that follow the rate allow only this kind.
  bool angle = false;
  // Interpreted as the Earth's rate, which is rotation: shown in a diagnosis, but neither corrected nor
  // written to a file.
  bool shown_only = false;
  std::string meaning;
  std::uint32_t line = 0;  // in the file; 0: not from a file
};

struct ChannelRange {
  std::string channel;  // or the difference of two, as in an effect
  double low = 0.0, high = 0.0;
  double early_s = 0.0;  // delay of its effect: the channel is logged early or acts later
  bool fades =
      false;  // of a channel that senses motion; its correction fades out beyond the range; not in files
};

inline constexpr double kMostEarly_s = 60.0;

// IEEE Std 952 coefficients, SI: Q rad, N rad/s/sqrt(Hz), B rad/s, K rad/s^2/sqrt(Hz), R rad/s^2; nullopt:
// not detected.
struct NoiseTerms {
  std::optional<double> Q{}, N{}, B{}, K{}, R{};
};

// By their keys in the file.
inline constexpr std::array<std::pair<const char*, std::optional<double> NoiseTerms::*>, 5> kNoiseTerms = {
    {{"Q", &NoiseTerms::Q},
     {"N", &NoiseTerms::N},
     {"B", &NoiseTerms::B},
     {"K", &NoiseTerms::K},
     {"R", &NoiseTerms::R}}};

struct ModelSource {
  std::string capture, sha256, date;            // fitted data
  std::map<std::string, double> before, after;  // held-out figures of the diagnosis
};

struct Model {
  static constexpr int kVersion = 1;
  std::string sensor;
  std::map<std::string, NoiseTerms> noise;  // by axis
  std::optional<FilterSettings> filter;     // from `ifog tune`
  std::vector<Effect> effects;
  // Covariance of all effect parameters in order, row-major, SI; empty if unknown. A file contains the rows
  // of effects that are corrected online; older files contain all rows.
  std::vector<double> covariance;
  std::vector<ChannelRange> ranges;
  ModelSource source;

  // First 12 hex digits of the SHA-256 of the file's text.
  [[nodiscard]] std::string identity() const;
};

// These throw std::runtime_error with one line: file, line or key, value, what was expected.
Model read_model(const std::string& path);
Model parse_model(std::string_view text, const std::string& name);  // `name`: file name for messages
// Text of the model file.
std::string model_text(const Model& model);

}  // namespace ifog

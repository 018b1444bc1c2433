// SPDX-License-Identifier: Apache-2.0
// Name of a number in an LCM message: `field` of a channel with source = "lcm".
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "filters/settings/axes.h"

namespace ifog {

// By axis, in ifog.rate_t and in ifog.status_t.
inline constexpr std::array<std::string_view, 3> kRateFields{"raw", "compensated", "denoised"};
inline constexpr std::array<std::string_view, 3> kStatusAxisFields{"nis_mean", "whiteness",
                                                                   "measurement_noise"};
inline constexpr std::string_view kChannelValueField = "channel_value";
inline constexpr const char* kLcmFieldExpected =
    "the name in an ifog.channel_t; raw[i], compensated[i], denoised[i] of an ifog.rate_t; "
    "channel_value[NAME], nis_mean[i], whiteness[i], measurement_noise[i] or a number of an ifog.status_t; "
    "i = 0 ... 2";

struct LcmFieldName {
  std::string name, within;  // NAME, and the text in brackets
  int axis = -1;             // −1: no axis

  [[nodiscard]] bool of_rate() const {
    return axis >= 0 && std::find(kRateFields.begin(), kRateFields.end(), name) != kRateFields.end();
  }

  // Parses "NAME", "FIELD[i]", "channel_value[NAME]". nullopt for brackets on another field.
  static std::optional<LcmFieldName> parse(const std::string& text) {
    LcmFieldName out;
    out.name = text.substr(0, text.find('['));
    if (out.name.size() == text.size()) return out;
    out.within = text.substr(out.name.size() + 1);
    if (out.within.empty() || out.within.back() != ']') return std::nullopt;
    out.within.pop_back();
    if (out.name == kChannelValueField) return out.within.empty() ? std::nullopt : std::optional(out);
    const bool by_axis =
        std::find(kRateFields.begin(), kRateFields.end(), out.name) != kRateFields.end() ||
        std::find(kStatusAxisFields.begin(), kStatusAxisFields.end(), out.name) != kStatusAxisFields.end();
    if (!by_axis || out.within.size() != 1 || out.within[0] < '0' || out.within[0] >= '0' + kMaxAxes)
      return std::nullopt;
    out.axis = out.within[0] - '0';
    return out;
  }
};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// Physical meaning of an effect, from the kind of its channel. The kind follows from the column's name
// (NAME_UNIT); an unknown name is allowed and only has no physical meaning.
#pragma once

#include <string>
#include <string_view>

#include "filters/model_file/form.h"

namespace ifog {

enum class ChannelKind {
  kTemperature,
  kAcceleration,
  kSupply,
  kMagneticField,
  kRamp,
  kPressure,
  kReferenceRate,
  kOtherAxis,
  kOther
};

[[nodiscard]] ChannelKind kind_of(std::string_view channel);

// A whole turn in the unit of an angle: degrees, radians or turns; 0 for other units.
[[nodiscard]] double turn_by_unit(std::string_view channel);

// Motion of the sensor that a channel senses, by unit and, if that is ambiguous, by name.
enum class Motion { kNone, kAngle, kRate, kPosition, kVelocity, kAcceleration };
[[nodiscard]] Motion motion_of(std::string_view channel);

// Value of the channel at which effects are zero by convention, so that coefficients are comparable: 25 degC,
// 12 V, else 0; 0 for differences.
[[nodiscard]] double reference_of(std::string_view channel);

// Unit of NAME_UNIT: "degC" of "case_temperature_degC"; "" if none.
[[nodiscard]] std::string unit_of(std::string_view channel);

// "linear of temperature_degC", and of a product both factors.
[[nodiscard]] std::string name_of(const Effect& effect);

// Meaning in one line.
[[nodiscard]] std::string meaning_of(const Effect& effect);

// The same for an effect of acceleration that is interpreted as the Earth's rate.
[[nodiscard]] std::string meaning_of_earth_rate(const Effect& effect);

// Unit of the effect's coefficient, e.g. "rad/s/degC^2".
[[nodiscard]] std::string coefficient_unit(const Effect& effect);

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// What an effect means physically, from the kind of channel it was traced to. The kind is read off the
// column's name (NAME_UNIT); an unknown name is no obstacle to the diagnosis, it only goes without a name for
// the physics.
#pragma once

#include <string>
#include <string_view>

#include "filters/effects/form.h"

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

// Degrees, radians or turns: what comes round.
[[nodiscard]] bool is_angle_by_unit(std::string_view channel);

// What of the sensor's own motion a channel senses, by its unit and, where that leaves it open, its name.
enum class Motion { kNone, kAngle, kRate, kPosition, kVelocity, kAcceleration };
[[nodiscard]] Motion motion_of(std::string_view channel);

// The channel's value at which effects are zero by convention, so that coefficients of different records
// compare: 25 degC, 12 V, 0 otherwise and for differences of two.
[[nodiscard]] double reference_of(std::string_view channel);

// The unit part of NAME_UNIT: "degC" of "case_temperature_degC"; "" when there is none.
[[nodiscard]] std::string unit_of(std::string_view channel);

// One line in plain words.
[[nodiscard]] std::string meaning_of(const Effect& effect);

// Likewise of an effect of an acceleration that is the Earth's rate by its first reading.
[[nodiscard]] std::string meaning_of_earth_rate(const Effect& effect);

// The unit of the effect's coefficient, "rad/s/degC^2".
[[nodiscard]] std::string coefficient_unit(const Effect& effect);

}  // namespace ifog

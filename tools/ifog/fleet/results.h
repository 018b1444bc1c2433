// SPDX-License-Identifier: Apache-2.0
// The results folder, the only thing that a fleet's processes share. Every file is written whole, and the
// file that marks a step as done is written last:
//
//   gyros/SERIAL/diagnosis.json, model.toml, report.html, gyro.json
//                                     output of `ifog diagnose`; gyro.json last
//   gyros/SERIAL/measured-ID.json     the type's effects in this gyro
//   gyros/SERIAL/with_prior.toml      the model with the type's prior
//   type.json                         the type's effects to measure, with ID
//   fleet.json, fleet.html            the population
//   log/INDEX.txt                     output of the processes of a gyro
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/measure.h"
#include "filters/model_file/model.h"
#include "filters/population/type_effects.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/fleet/manifest.h"

namespace ifog {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ModelParameter, name, value, std_error, unit)
// Identity of an effect, without the table of a "lookup", which differs between gyros.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Effect, axis, form, channel, with_form, with_channel, reference,
                                   with_reference, period, meaning, parameters)
}  // namespace ifog

namespace ifog::tools {

// The type's effects, all on the axes of one sensor.
struct TypeToMeasure {
  std::string id;    // of the effects; 16 hex digits
  std::string type;  // its name
  std::vector<TypeCandidate> effects;
};

// State of a gyro's own diagnosis.
struct GyroDone {
  std::string serial;
  std::vector<std::string> captures;
  std::string inputs;                 // identity_of() the captures and options
  std::optional<std::string> failed;  // reason if it failed
};

// A measured effect with its number in the type.
struct EffectOfType : MeasuredEffect {
  std::size_t of_type = 0;
};

// On one axis; see MeasuredEffects.
struct AxisMeasured {
  std::string axis;
  std::vector<EffectOfType> together;  // those of this axis
  std::vector<Effect> beside;          // others of the model, fitted with them
  std::vector<double> covariance, means;
  std::vector<ChannelRange> ranges;
};

struct GyroMeasured {
  std::string serial;
  std::string type;  // its id
  std::string inputs;
  std::optional<std::string> failed;
  std::vector<AxisMeasured> axes;
};

class Results {
 public:
  // Makes the folder if necessary. Throws std::runtime_error with one line.
  explicit Results(std::string folder);

  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] std::string path(const std::string& file) const;
  [[nodiscard]] std::string log(std::size_t gyro) const;
  // `, see LOG`, the file with the output of a gyro's process, or the reason why it could not be written.
  [[nodiscard]] std::string see_log(std::size_t gyro) const;
  // Path of a file in the gyro's folder.
  [[nodiscard]] std::string path(const FleetGyro& gyro, const std::string& file) const;
  // Call it before writing anything of the gyro.
  void make_folder_of(const FleetGyro& gyro) const;

  // nullopt if it is missing or unreadable; then it is made again.
  [[nodiscard]] std::optional<TypeToMeasure> type() const;
  [[nodiscard]] std::optional<GyroDone> done(const FleetGyro& gyro) const;
  [[nodiscard]] std::optional<GyroMeasured> measured(const FleetGyro& gyro, const std::string& type_id) const;

  // Also sets the id of the effects.
  void write(TypeToMeasure& type) const;
  void write(const FleetGyro& gyro, const GyroDone& done) const;
  void write(const FleetGyro& gyro, const GyroMeasured& measured) const;

  // Removes a file, if it exists, by its name in the folder or in that of a gyro. Throws as above.
  void forget(const std::string& file) const;
  void forget(const FleetGyro& gyro, const std::string& file) const;

 private:
  std::string folder_;
};

// Name of the file with a type's measured effects, in the gyro's folder.
std::string measured_name(const std::string& type_id);

// Identifies the captures with these options: by size and time of the files, because reading days of data
// takes too long.
std::string identity_of(const FleetGyro& gyro, const std::string& options);

}  // namespace ifog::tools

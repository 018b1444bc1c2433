// SPDX-License-Identifier: Apache-2.0
// The folder of a fleet's results, which is all that its processes share. Every file is there whole or not at
// all, and what says that a step is done is written last:
//
//   gyros/SERIAL/diagnosis.json, model.toml, report.html, gyro.json
//                                     what `ifog diagnose` says; gyro.json last
//   gyros/SERIAL/measured-ID.json     the type's effects in this gyro
//   gyros/SERIAL/with_prior.toml      the model with what the type adds
//   type.json                         the type's effects as they are measured, of ID
//   fleet.json, fleet.html            the population
//   log/INDEX.txt                     what the processes of a gyro said
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/measure.h"
#include "filters/model_file/model.h"
#include "filters/population/type_effects.h"
#include "tools/ifog/console/listed_fields.h"
#include "tools/ifog/fleet/manifest.h"

namespace ifog::tools {

// The type's effects, all of one sensor's axes.
struct TypeToMeasure {
  std::vector<TypeCandidate> effects;
  std::string id;  // of the file's content; 16 hex digits
};

// The result of a gyro's own diagnosis.
struct GyroDone {
  std::string inputs;                 // of which captures, with which options
  std::optional<std::string> failed;  // why there is none
};

// An effect of the type: its number there.
struct EffectOfType : MeasuredEffect {
  std::size_t of_type = 0;
};

// On one axis; see MeasuredEffects.
struct AxisMeasured {
  std::string axis;
  std::vector<EffectOfType> together;  // those of this axis
  std::vector<Effect> others;
  std::vector<double> covariance;
  std::vector<ChannelRange> ranges;
};

struct GyroMeasured {
  std::string inputs;
  std::optional<std::string> failed;
  std::vector<AxisMeasured> axes;
};

class Results {
 public:
  // Makes the folder where it is not there. Throws std::runtime_error with one line.
  explicit Results(std::string folder);

  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] std::string path(const std::string& file) const;
  [[nodiscard]] std::string log(std::size_t gyro) const;
  // Where it is to be read why a process of the gyro failed: `, see LOG`, or why nothing could be said there.
  [[nodiscard]] std::string see_log(std::size_t gyro) const;
  // In the gyro's folder.
  [[nodiscard]] std::string path(const FleetGyro& gyro, const std::string& file) const;
  // Before anything of it is written.
  void make_folder_of(const FleetGyro& gyro) const;

  // nullopt where there is none, or it cannot be read: it is made again.
  [[nodiscard]] std::optional<TypeToMeasure> type() const;
  [[nodiscard]] std::optional<GyroDone> done(const FleetGyro& gyro) const;
  [[nodiscard]] std::optional<GyroMeasured> measured(const FleetGyro& gyro, const std::string& type_id) const;

  // The effects get their id.
  void write_type(const std::string& type, TypeToMeasure& effects) const;
  void forget_type() const;
  void forget_done(const FleetGyro& gyro) const;
  void forget_measured(const FleetGyro& gyro, const std::string& type_id) const;
  // What the population gave to the gyro, and what was written of the population.
  void forget_with_prior(const FleetGyro& gyro) const;
  void forget_population() const;
  void write_done(const FleetGyro& gyro, const GyroDone& done) const;
  void write_measured(const FleetGyro& gyro, const std::string& type_id, const GyroMeasured& measured) const;

 private:
  std::string folder_;
};

// Names these captures as they are now, read with these options: sizes and times of the files, not their
// content, which is days of data.
std::string identity_of(const FleetGyro& gyro, const std::string& options);

template <typename Io, Is<ModelParameter> T>
void fields(Io& io, T& of) {
  io("name", of.name);
  io("value", of.value);
  io("std_error", of.std_error);
  io("unit", of.unit);
}
// What tells it from others, without the table of a "lookup", which is no type's.
template <typename Io, Is<Effect> T>
void fields(Io& io, T& of) {
  io("axis", of.axis);
  io("form", of.form);
  io("channel", of.channel);
  io("with_form", of.with_form);
  io("with_channel", of.with_channel);
  io("reference", of.reference);
  io("with_reference", of.with_reference);
  io("period", of.period);
  io("meaning", of.meaning);
  io("parameters", of.parameters);
}

}  // namespace ifog::tools

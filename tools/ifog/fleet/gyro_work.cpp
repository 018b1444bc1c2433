// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/gyro_work.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "drivers/capture/files/input_file.h"
#include "drivers/capture/files/output_file.h"
#include "filters/model_file/sha256.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

void diagnose_gyro(const Results& results, const FleetGyro& gyro, const FleetSettings& settings,
                   const PreparedCaptures& opened) {
  AxesToDiagnose wanted = settings.wanted;
  wanted.threads = 1;  // other processors work on other gyros
  const std::vector<AxisDiagnosis> found = diagnose_axes(opened.views, gyro.captures, wanted);
  Model model = model_with({}, found, gyro.captures, opened.hashes);
  model.sensor = gyro.serial;
  const std::string model_path = results.path(gyro, "model.toml");
  results.forget(gyro, "gyro.json");  // until all files belong to this diagnosis
  write_json(results.path(gyro, "diagnosis.json"), diagnosis_json(found));
  write_file(model_path, model_text(model));
  write_file(results.path(gyro, "report.html"),
             diagnosis_report(opened.views, found, gyro.captures, opened.hashes, model_path,
                              settings.input.as_typed()));
}

EffectsToMeasure effects_of_axis(const TypeToMeasure& type, const Model& model, const std::string& axis,
                                 std::vector<std::size_t>& numbers) {
  EffectsToMeasure wanted;
  wanted.ranges = model.ranges;
  for (std::size_t i = 0; i < type.effects.size(); ++i) {
    const std::vector<Effect>& forms = type.effects[i].forms;
    if (forms.empty() || forms.front().axis != axis) continue;
    numbers.push_back(i);
    // With the gyro's own time constant, which differs from gyro to gyro; the type's where it has none.
    const auto own = std::ranges::find_if(model.effects, [&](const Effect& effect) {
      return effect.axis == axis && effect.form == forms.front().form && is_of(type.effects[i], effect);
    });
    wanted.together.push_back(own == model.effects.end() ? forms.front() : *own);
    wanted.instead.emplace_back(forms.begin() + 1, forms.end());
  }
  for (const Effect& effect : model.effects) {
    const bool of_the_type =
        std::ranges::any_of(type.effects, [&](const TypeCandidate& each) { return is_of(each, effect); });
    if (effect.axis == axis && !of_the_type) wanted.others.push_back(effect);
  }
  return wanted;
}

// Throws if a coefficient has no finite error, e.g. of a column that is constant after cleaning.
void refuse_without_error(AxisMeasured& axis) {
  for (MeasuredEffect& each : axis.together) {
    if (!each.not_measured.empty()) continue;
    const ModelParameter& coefficient = each.effect.parameters.front();
    if (!std::isfinite(coefficient.value) || !std::isfinite(coefficient.std_error) ||
        !(coefficient.std_error > 0.0))
      throw refusal("{} of {} has no finite error on these captures", each.effect.form, each.effect.channel);
  }
}

std::vector<AxisMeasured> measure_gyro(const Results& results, const FleetGyro& gyro,
                                       const FleetSettings& settings, const TypeToMeasure& type,
                                       const PreparedCaptures& opened) {
  const Model model = read_model(results.path(gyro, "model.toml"));
  std::vector<AxisMeasured> measured;
  const std::vector<std::string>& axes = opened.views.front().axes;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    AxisMeasured axis;
    axis.axis = axes[a];
    std::vector<std::size_t> numbers;
    const EffectsToMeasure wanted = effects_of_axis(type, model, axes[a], numbers);
    if (wanted.together.empty()) continue;
    MeasuredEffects found = naming(gyro.captures.front(), [&] {
      return measure_effects(records_of(opened.views, gyro.captures, a), wanted, axes[a],
                             settings.wanted.options.significance);
    });
    for (std::size_t i = 0; i < numbers.size(); ++i)
      axis.together.push_back({std::move(found.together[i]), numbers[i]});
    axis.beside = std::move(found.others);
    axis.covariance = std::move(found.covariance);
    axis.means = std::move(found.means);
    axis.ranges = std::move(found.ranges);
    refuse_without_error(axis);
    measured.push_back(std::move(axis));
  }
  return measured;
}

// Hash of the files named by a driver's options, because a file may have changed under the same name.
std::string files_of(const DriverSettings& settings) {
  std::string text;
  for (const auto& [key, value] : settings)
    if (std::error_code none; std::filesystem::is_regular_file(value, none))
      text += " " + key + "=" + sha256_hex(read_whole_file(value));
  return text;
}

}  // namespace

std::string FleetSettings::text() const {
  const DiagnoseOptions& options = wanted.options;
  const nlohmann::json of_diagnosis = {wanted.axes,
                                       part.from.text,
                                       part.to.text,
                                       options.significance,
                                       options.subtract_earth_rate,
                                       options.latitude_rad.value_or(NAN)};
  // Another version may have other results.
  return "ifog " IFOG_VERSION + input.as_typed() + files_of(input.settings()) + of_diagnosis.dump();
}

bool is_diagnosed(const Results& results, const FleetGyro& gyro, const std::string& options) {
  const std::optional<GyroDone> done = results.done(gyro);
  const auto has = [&](const char* file) {
    std::error_code none;
    return std::filesystem::is_regular_file(results.path(gyro, file), none);
  };
  return done && !done->failed && done->inputs == identity_of(gyro, options) && has("diagnosis.json") &&
         has("model.toml");
}

bool is_measured(const Results& results, const FleetGyro& gyro, const std::string& options,
                 const TypeToMeasure& type) {
  const std::optional<GyroMeasured> measured = results.measured(gyro, type.id);
  return measured && !measured->failed && measured->inputs == identity_of(gyro, options);
}

void work_on(const Results& results, const FleetGyro& gyro, const FleetSettings& settings) {
  const std::string options = settings.text();
  results.make_folder_of(gyro);
  // Before reading: a file that changes while it is read is processed again.
  const std::string inputs = identity_of(gyro, options);
  const auto read = [&] {
    return settings.input.prepared(gyro.captures, {.part = settings.part, .hashed = true});
  };
  std::optional<PreparedCaptures> opened;
  if (!is_diagnosed(results, gyro, options)) {
    try {
      opened = read();
      diagnose_gyro(results, gyro, settings, *opened);
    } catch (const std::runtime_error& error) {
      results.write(gyro, GyroDone{gyro.serial, gyro.captures, inputs, error.what()});
      throw;
    }
    results.write(gyro, GyroDone{gyro.serial, gyro.captures, inputs, std::nullopt});
    say("{}: diagnosed\n", gyro.serial);
  }
  const std::optional<TypeToMeasure> type = results.type();
  if (!type || type->effects.empty() || is_measured(results, gyro, options, *type)) return;
  GyroMeasured measured{gyro.serial, type->id, inputs, std::nullopt, {}};
  try {
    if (!opened) opened = read();
    measured.axes = measure_gyro(results, gyro, settings, *type, *opened);
  } catch (const std::runtime_error& error) {
    measured.failed = error.what();
    results.write(gyro, measured);
    throw;
  }
  results.write(gyro, measured);
  say("{}: measured\n", gyro.serial);
}

}  // namespace ifog::tools

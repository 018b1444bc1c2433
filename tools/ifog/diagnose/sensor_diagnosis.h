// SPDX-License-Identifier: Apache-2.0
// The work of `ifog diagnose` between reading and writing: from the captures of one sensor to its errors and
// the model that corrects them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/diagnosis/diagnose.h"
#include "filters/model_file/model.h"
#include "tools/ifog/console/command.h"

namespace ifog::tools {

struct AxesToDiagnose {
  std::vector<std::string> axes;  // empty: all
  DiagnoseOptions options;        // without the axis and the progress
  unsigned threads = 0;           // axes in parallel; 0: all. The result does not depend on it

  // Adds --earth and --latitude to a command; this must outlive it.
  void add_earth_to(const Command& command);
};

struct AxisDiagnosis {
  std::string axis;  // "" for a single-axis sensor
  Diagnosis diagnosis;
};

// names: of the captures, for messages, one each. Throws std::runtime_error with one line: captures with
// different axes, too short, or without the wanted axes.
std::vector<AxisDiagnosis> diagnose_axes(const std::vector<CaptureView>& captures,
                                         const std::vector<std::string>& names, const AxesToDiagnose& wanted);

// The records of one axis; the captures must outlive them.
std::vector<Record> records_of(const std::vector<CaptureView>& captures,
                               const std::vector<std::string>& names, std::size_t axis);

// Adds the found effects to `model`. hashes: SHA-256 of the captures.
Model model_with(Model model, const std::vector<AxisDiagnosis>& found, const std::vector<std::string>& names,
                 const std::vector<std::string>& hashes);

// The HTML page. hashes: as above. model_path: "" if there is no model file. read_with: the captures'
// options, as typed.
std::string diagnosis_report(const std::vector<CaptureView>& captures,
                             const std::vector<AxisDiagnosis>& found, const std::vector<std::string>& names,
                             const std::vector<std::string>& hashes, const std::string& model_path,
                             const std::string& read_with);

// Schema ifog.diagnosis/1. One axis: the keys of the schema at the top level. Several axes: effects, alternatives and noise of all
// axes have an "axis", and the figures are objects by axis.
nlohmann::ordered_json diagnosis_json(const std::vector<AxisDiagnosis>& axes);

// For the console.
std::string diagnosis_text(const AxisDiagnosis& axis);

}  // namespace ifog::tools

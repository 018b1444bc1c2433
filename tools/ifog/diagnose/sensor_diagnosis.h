// SPDX-License-Identifier: Apache-2.0
// From the captures of one sensor to what is wrong with it and the model that corrects it: what `ifog
// diagnose` does between reading and writing, for whoever reads and writes otherwise.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"
#include "filters/model_file/model.h"
#include "tools/ifog/captures/capture_view.h"
#include "tools/ifog/diagnose/diagnosis_json.h"

namespace ifog::tools {

struct AxesToDiagnose {
  std::vector<std::string> axes;  // empty: all
  double significance = 0.01;
  double fit_from = 0.0, fit_to = 1.0;  // DiagnoseOptions, as the rest
  bool earth = false;
  std::optional<double> latitude_rad;
  bool allow_motion_channels = false, allow_proxies = false;
  unsigned threads = 0;  // axes at once; 0: as many as there are processors. The result is the same
};

// names: of the captures, for messages, one each. Throws std::runtime_error with one line: captures with
// different axes, too short, none of the axes wanted.
std::vector<AxisDiagnosis> diagnose_axes(const std::vector<CaptureView>& captures,
                                         const std::vector<std::string>& names, const AxesToDiagnose& wanted);

// One axis of the captures as a diagnosis takes it, which must outlive this.
std::vector<Record> records_of(const std::vector<CaptureView>& captures,
                               const std::vector<std::string>& names, std::size_t axis);

// `model` with what was found added to its own. hashes: SHA-256 of the captures.
Model model_with(Model model, const std::vector<AxisDiagnosis>& found, const std::vector<std::string>& names,
                 const std::vector<std::string>& hashes);

// The HTML page. hashes: as above. model_path: where the model is, "" for nowhere. read_with: the captures'
// options, as typed.
std::string diagnosis_report(const std::vector<CaptureView>& captures,
                             const std::vector<AxisDiagnosis>& found, const std::vector<std::string>& names,
                             const std::vector<std::string>& hashes, const std::string& model_path,
                             const std::string& read_with);

}  // namespace ifog::tools

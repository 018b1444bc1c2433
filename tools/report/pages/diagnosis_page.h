// SPDX-License-Identifier: Apache-2.0
// The report of a diagnosis as one self-contained HTML page: inline SVG, CSS and a few lines of script
// that show values and let one look closer; nothing fetched; light and dark, fit for a screen reader, a
// telephone and paper.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"

namespace ifog::report {

struct PageAxis {
  std::string axis;  // "" for a single-axis sensor
  const Diagnosis* diagnosis = nullptr;
  std::vector<Record> records;  // what it was made from
};

struct Page {
  std::string sensor;                 // for the title
  std::vector<std::string> captures;  // as the user named them
  std::vector<PageAxis> axes;
  std::string read_with;   // options that the captures are read with, as a shell takes them: " --driver NAME"
  std::string model_path;  // that was written; "" when none
  std::string made;        // date and program version
  std::string command;     // as it was typed; "" when not known
  struct Input {
    std::string name, sha256;           // of the file as unpacked; "" when not known
    std::vector<std::string> comments;  // the file's own
  };
  std::vector<Input> inputs;
};

std::string diagnosis_page(const Page& page);

}  // namespace ifog::report

// SPDX-License-Identifier: Apache-2.0
// The report of a diagnosis as one HTML page with its SVG, CSS and script; it loads no other resource. For
// light and dark mode, screen readers, phones and print.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"

namespace ifog::report {

struct PageAxis {
  std::string axis;  // "" for a single-axis sensor
  const Diagnosis* diagnosis = nullptr;
  std::vector<Record> records;  // its input
};

struct Page {
  std::string sensor;                 // for the title
  std::vector<std::string> captures;  // as given by the user
  std::vector<PageAxis> axes;
  std::string read_with;   // options for reading the captures, in shell syntax: " --driver NAME"
  std::string model_path;  // of the written model; "" if none
  std::string made;        // date and program version
  std::string command;     // as typed; "" if unknown
  struct Input {
    std::string name, sha256;           // of the unpacked file; "" if unknown
    std::vector<std::string> comments;  // from the file
  };
  std::vector<Input> inputs;
};

std::string diagnosis_page(const Page& page);

}  // namespace ifog::report

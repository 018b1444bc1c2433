// The report of a diagnosis as one self-contained HTML page: inline SVG and CSS, nothing fetched, no script,
// light and dark, fit for a screen reader and for paper.
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
  std::string model_path;  // that was written; "" when none
  std::string made;        // date and program version
};

std::string diagnosis_page(const Page& page);

}  // namespace ifog::report

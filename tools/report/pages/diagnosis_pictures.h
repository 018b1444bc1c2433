// SPDX-License-Identifier: Apache-2.0
// The pictures of a diagnosis, each a <figure> with caption; "" if there is nothing to draw.
#pragma once

#include <cstddef>
#include <string>

#include "tools/report/pages/diagnosis_page.h"

namespace ifog::report {

std::string time_picture(const Diagnosis& d);
std::string spectrum_picture(const Diagnosis& d);
std::string allan_picture(const Diagnosis& d);
// For one effect: the error against its channel, and its part over time.
std::string traced_picture(const PageAxis& axis, std::size_t index);
std::string contribution_picture(const Diagnosis& d, std::size_t index);
std::string heading_picture(const HeadingPrediction& h);

}  // namespace ifog::report

// SPDX-License-Identifier: Apache-2.0
// A model beside the axes of a capture that it is to correct.
#pragma once

#include <string>
#include <vector>

#include "filters/model_file/model.h"
#include "filters/model_file/model_axes.h"

namespace ifog::tools {

// Tells on standard error where effects that name no axis, those of a sensor that has one, are subtracted
// from each of several. path: of the model.
void tell_model_of_one_axis(const Model& model, const std::string& path,
                            const std::vector<std::string>& axes);

// The model for a capture from which these axes of its sensor were left out: less the effects that are of
// them or depend on their rates. What of the others is lost by that is told; the rest of it stays as it was.
[[nodiscard]] Model without_axes(Model model, const std::vector<std::string>& axes);

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/model_axes.h"

#include <algorithm>

#include "tools/ifog/console/say.h"

namespace ifog::tools {

void tell_model_of_one_axis(const Model& model, const std::string& path,
                            const std::vector<std::string>& axes) {
  if (const std::string remark = effects_of_no_axis(model, axes); !remark.empty())
    warn("%s: %s\n", path.c_str(), remark.c_str());
}

}  // namespace ifog::tools

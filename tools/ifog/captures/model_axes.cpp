// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/model_axes.h"

#include <algorithm>

#include "tools/ifog/console/say.h"

namespace ifog::tools {

void tell_model_of_one_axis(const Model& model, const std::string& path,
                            const std::vector<std::string>& axes) {
  const auto nameless = std::count_if(model.effects.begin(), model.effects.end(),
                                      [](const Effect& effect) { return effect.axis.empty(); });
  if (nameless == 0 || axes.size() < 2) return;
  std::string list;
  for (const std::string& axis : axes) list += (list.empty() ? "" : ", ") + axis;
  warn(
      "%s: %lld of its effects are of a sensor with one axis and are subtracted from each of %s; expected "
      "effects with an axis\n",
      path.c_str(), static_cast<long long>(nameless), list.c_str());
}

}  // namespace ifog::tools

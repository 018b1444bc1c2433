// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/model_axes.h"

#include <algorithm>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "filters/effects/form.h"
#include "filters/model_file/covariance.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {

void tell_model_of_one_axis(const Model& model, const std::string& path,
                            const std::vector<std::string>& axes) {
  if (const std::string remark = effects_of_no_axis(model, axes); !remark.empty())
    warn("%s: %s\n", path.c_str(), remark.c_str());
}

Model without_axes(Model model, const std::vector<std::string>& axes) {
  const auto is_out = [&](const std::string& axis) {
    return !axis.empty() && std::find(axes.begin(), axes.end(), axis) != axes.end();
  };
  std::vector<Effect> effects;
  std::vector<std::size_t> rows;  // of the covariance, that stay
  std::size_t all = 0;
  for (Effect& effect : model.effects) {
    const std::size_t first = all;
    all += effect.parameters.size();
    if (is_out(effect.axis)) continue;
    const bool of_rate = is_out(axis_of_rate(effect.channel));
    if (of_rate || is_out(axis_of_rate(effect.with_channel))) {
      warn("not corrected: %s of %s%s: that axis was dropped\n", effect.form.c_str(),
           printable(of_rate ? effect.channel : effect.with_channel).c_str(),
           effect.axis.empty() ? "" : (" in " + effect.axis).c_str());
      continue;
    }
    for (std::size_t row = first; row < all; ++row) rows.push_back(row);
    effects.push_back(std::move(effect));
  }
  model.effects = std::move(effects);
  if (model.covariance.size() != all * all || rows.size() == all) return model;
  model.covariance = of_rows(model.covariance, all, rows);
  return model;
}

}  // namespace ifog::tools

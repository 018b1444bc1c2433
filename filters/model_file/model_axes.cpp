// SPDX-License-Identifier: Apache-2.0
#include "filters/model_file/model_axes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/ifog/quoted.h"

namespace ifog {

namespace {

std::string listed(std::span<const std::string> axes) {
  std::string list;
  for (const std::string& axis : axes) list += (list.empty() ? "" : ", ") + axis;
  return list;
}

}  // namespace

std::string effects_of_no_axis(const Model& model, std::span<const std::string> axes) {
  const auto nameless = std::count_if(model.effects.begin(), model.effects.end(),
                                      [](const Effect& effect) { return effect.axis.empty(); });
  if (nameless == 0 || axes.size() < 2) return "";
  return std::to_string(nameless) +
         " of its effects belong to a sensor with one axis and are subtracted from each of " + listed(axes) +
         "; expected effects with an axis";
}

std::vector<std::string> remarks_on_axes(const Model& model, std::span<const std::string> axes) {
  std::vector<std::string> remarks;
  if (std::string remark = effects_of_no_axis(model, axes); !remark.empty())
    remarks.push_back(std::move(remark));
  const std::string here = listed(axes);
  for (const auto& [axis, noise] : model.noise)
    if (!axis.empty() && std::find(axes.begin(), axes.end(), axis) == axes.end())
      remarks.push_back("has the noise of an axis " + in_quotes(axis) + ", of which there is none here" +
                        (here.empty() ? "" : ", but " + here));
  return remarks;
}

AxisNoiseTerms mean_noise_terms(const Model& model, std::span<const std::string> axes) {
  const auto mean = [&](std::optional<double> NoiseTerms::*term) -> std::optional<double> {
    double sum = 0.0;
    for (const std::string& axis : axes) {
      const auto found = model.noise.find(axis);
      if (found == model.noise.end() || !(found->second.*term)) return std::nullopt;
      sum += std::pow(*(found->second.*term), 2);
    }
    if (!(sum > 0.0)) return std::nullopt;
    return sum / static_cast<double>(axes.size());
  };
  return {mean(&NoiseTerms::N), mean(&NoiseTerms::K)};
}

AxisShares axis_shares(const Model& model, std::span<const std::string> axes) {
  if (axes.size() < 2 || axes.size() > kMaxAxes) return {};
  const auto shares = [&](std::optional<double> NoiseTerms::*term) -> std::optional<Axes> {
    Axes of{1.0, 1.0, 1.0};
    double mean = 0.0;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      const auto found = model.noise.find(axes[a]);
      if (found == model.noise.end() || !(found->second.*term)) return std::nullopt;
      const double value = *(found->second.*term);
      of[a] = value * value;
      if (!(of[a] > 0.0)) return std::nullopt;
      mean += of[a] / static_cast<double>(axes.size());
    }
    for (std::size_t a = 0; a < axes.size(); ++a) of[a] /= mean;
    return of;
  };
  return {shares(&NoiseTerms::N), shares(&NoiseTerms::K)};
}

}  // namespace ifog

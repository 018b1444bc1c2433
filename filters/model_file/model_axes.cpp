// SPDX-License-Identifier: Apache-2.0
#include "filters/model_file/model_axes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "drivers/ifog/quoted.h"

namespace ifog {

namespace {

std::string listed(std::span<const std::string> axes) {
  std::string list;
  for (const std::string& axis : axes) list += (list.empty() ? "" : ", ") + axis;
  return list;
}

// Squares of one term, by axis.
std::optional<Axes> squares(const Model& model, std::span<const std::string> axes,
                            std::optional<double> NoiseTerms::*term) {
  Axes of{};
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const auto found = model.noise.find(axes[a]);
    if (found == model.noise.end() || !(found->second.*term)) return std::nullopt;
    of[a] = std::pow(*(found->second.*term), 2);
    if (!(of[a] > 0.0)) return std::nullopt;
  }
  return of;
}

}  // namespace

std::string effects_of_no_axis(const Model& model, std::span<const std::string> axes) {
  const auto nameless =
      std::ranges::count_if(model.effects, [](const Effect& effect) { return effect.axis.empty(); });
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

NoiseOfAxes noise_of_axes(const Model& model, std::span<const std::string> axes, double sample_rate_hz,
                          double measurement_noise) {
  NoiseOfAxes out;
  if (axes.size() > kMaxAxes) return out;
  const std::optional<Axes> white = squares(model, axes, &NoiseTerms::N),
                            walk = squares(model, axes, &NoiseTerms::K);
  const auto mean = [&](const Axes& of) {
    return std::accumulate(of.begin(), of.end(), 0.0) / static_cast<double>(axes.size());
  };
  const auto shares = [&](Axes of) {
    const double all = mean(of);
    for (double& one : of) one /= all;
    return of;
  };
  if (walk) out.walk = mean(*walk);
  if (walk) out.shares.walk = shares(*walk);
  if (!white) return out;
  Axes sample = *white;
  for (double& one : sample) one *= sample_rate_hz;
  out.sample = mean(sample);
  if (measurement_noise > 2.0 * *out.sample)
    for (std::size_t a = 0; a < axes.size(); ++a) sample[a] += measurement_noise - *out.sample;
  out.shares.noise = shares(sample);
  return out;
}

}  // namespace ifog

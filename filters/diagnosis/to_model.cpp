#include <algorithm>

#include "filters/diagnosis/diagnosis.h"

namespace ifog {

void add_to_model(const Diagnosis& diagnosis, const std::string& axis, Model& model) {
  std::size_t old = 0;
  for (const Effect& effect : model.effects) old += effect.parameters.size();
  std::size_t added = 0;
  for (const FoundEffect& found : diagnosis.effects) {
    model.effects.push_back(found.effect);
    model.effects.back().axis = axis;
    added += found.effect.parameters.size();
  }
  // Axes are fitted apart, so nothing is known of covariances across them: zero.
  std::vector<double> covariance((old + added) * (old + added), 0.0);
  for (std::size_t i = 0; i < old && model.covariance.size() == old * old; ++i) {
    for (std::size_t j = 0; j < old; ++j) covariance[i * (old + added) + j] = model.covariance[i * old + j];
  }
  for (std::size_t i = 0; i < added; ++i) {
    for (std::size_t j = 0; j < added; ++j) {
      covariance[(old + i) * (old + added) + old + j] = diagnosis.covariance[i * added + j];
    }
  }
  model.covariance = std::move(covariance);
  for (const ChannelRange& range : diagnosis.ranges) {
    const auto known = std::find_if(model.ranges.begin(), model.ranges.end(), [&](const ChannelRange& other) {
      return other.channel == range.channel;
    });
    if (known == model.ranges.end()) {
      model.ranges.push_back(range);
    } else {
      known->low = std::min(known->low, range.low);
      known->high = std::max(known->high, range.high);
    }
  }
  model.noise[axis] = diagnosis.noise;
}

}  // namespace ifog

#include "filters/models/state_model.h"

#include <stdexcept>

#include "filters/models/random_walk.h"

namespace ifog {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& expected) {
  throw std::invalid_argument("state: '" + name + "', expected " + expected);
}

}  // namespace

std::vector<std::string> state_model_names() { return {"random-walk", "integrated-random-walk"}; }

std::unique_ptr<StateModel> make_state_model(const std::string& name, std::span<const double> parameters,
                                             double nominal_period_s) {
  if (name == "random-walk" || name == "integrated-random-walk") {
    if (!parameters.empty()) refuse(name, "no state_parameters");
    if (name == "random-walk") return std::make_unique<RandomWalk>();
    return std::make_unique<IntegratedRandomWalk>(nominal_period_s);
  }
  std::string list;
  for (const std::string& known : state_model_names()) list += (list.empty() ? "" : ", ") + known;
  refuse(name, "one of " + list);
}

}  // namespace ifog

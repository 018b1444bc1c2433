// What the estimator does at each step, whatever the size of the state. The sizes are instantiated in
// engine.cpp.
#pragma once

#include <memory>

#include "filters/estimator/estimator.h"
#include "filters/models/state_model.h"
#include "filters/rules/rule.h"

namespace ifog {

class Engine {
 public:
  virtual ~Engine() = default;
  virtual void step(const EstimatorInput& in, EstimatorOutput& out) noexcept = 0;
  virtual void restart() noexcept = 0;
  [[nodiscard]] virtual const EstimatorHealth& health() const noexcept = 0;
};

struct EngineParts {
  FilterSettings settings;
  std::unique_ptr<StateModel> model;
  std::unique_ptr<Rule> rule;
  int axes = 1;
  double period_s = 0.0;
};

// Picks the instantiation for the model's number of states.
std::unique_ptr<Engine> make_engine(EngineParts parts);

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// Sum of independent processes: block-diagonal transition, joined measurement vectors.
#pragma once

#include <memory>
#include <vector>

#include "filters/state_models/state_model.h"

namespace ifog {

class Sum final : public StateModel {
 public:
  struct Term {
    std::unique_ptr<StateModel> model;
    double noise_ratio = 1.0;  // its driving noise / process_noise
  };
  explicit Sum(std::vector<Term> terms);

  [[nodiscard]] int states() const noexcept override { return states_; }
  void discretise(double dt_s, StateMatrixRef transition, StateMatrixRef driving) const noexcept override;
  [[nodiscard]] Eigen::VectorXd measurement() const override { return joined(&StateModel::measurement); }
  [[nodiscard]] Eigen::VectorXd rate() const override;
  [[nodiscard]] Eigen::VectorXd level() const override;
  [[nodiscard]] bool carries_level() const noexcept override;
  [[nodiscard]] Eigen::MatrixXd stationary() const override;
  [[nodiscard]] Eigen::MatrixXd colour() const override;
  [[nodiscard]] Eigen::VectorXd diffuse() const override { return joined(&StateModel::diffuse); }
  [[nodiscard]] Eigen::VectorXd start() const override { return joined(&StateModel::start); }

 private:
  // True for the terms that are the rate; `first` is the term's first state.
  [[nodiscard]] bool is_rate(const Term& term, int first) const {
    return carries_level() ? term.model->carries_level() : first == 0;
  }

  template <class Use>
  void for_each(Use use) const;
  // The terms' vectors, one after the other.
  [[nodiscard]] Eigen::VectorXd joined(Eigen::VectorXd (StateModel::*part)() const) const;

  std::vector<Term> terms_;
  int states_ = 0;
};

}  // namespace ifog

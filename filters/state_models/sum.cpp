// SPDX-License-Identifier: Apache-2.0
#include "filters/state_models/sum.h"

#include <algorithm>
#include <utility>

namespace ifog {

Sum::Sum(std::vector<Term> terms) : terms_(std::move(terms)) {
  for (const Term& term : terms_) states_ += term.model->states();
}

// Calls use(term, first state, number of states) for each term.
template <class Use>
void Sum::for_each(Use use) const {
  int first = 0;
  for (const Term& term : terms_) {
    use(term, first, term.model->states());
    first += term.model->states();
  }
}

Eigen::VectorXd Sum::joined(Eigen::VectorXd (StateModel::*part)() const) const {
  Eigen::VectorXd all(states_);
  for_each([&](const Term& term, int first, int n) { all.segment(first, n) = (*term.model.*part)(); });
  return all;
}

void Sum::discretise(double dt_s, StateMatrixRef transition, StateMatrixRef driving) const noexcept {
  transition.setZero();
  driving.setZero();
  for_each([&](const Term& term, int first, int n) {
    term.model->discretise(dt_s, transition.block(first, first, n, n), driving.block(first, first, n, n));
    driving.block(first, first, n, n) *= term.noise_ratio;
  });
}

Eigen::VectorXd Sum::rate() const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(states_);
  for_each([&](const Term& term, int first, int n) {
    if (is_rate(term, first)) all.segment(first, n) = term.model->rate();
  });
  return all;
}

Eigen::MatrixXd Sum::stationary() const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(states_, states_);
  for_each([&](const Term& term, int first, int n) {
    all.block(first, first, n, n) = term.noise_ratio * term.model->stationary();
  });
  return all;
}

Eigen::MatrixXd Sum::colour() const {
  Eigen::MatrixXd all = stationary();
  for_each([&](const Term& term, int first, int n) {
    if (is_rate(term, first)) all.block(first, first, n, n).setZero();
  });
  return all;
}

// The level is carried by the first term that says so, or else by the first one.
Eigen::VectorXd Sum::level() const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(states_);
  bool carried = false;
  for_each([&](const Term& term, int first, int n) {
    if (!carried && is_rate(term, first)) all.segment(first, n) = term.model->level();
    carried = carried || is_rate(term, first);
  });
  return all;
}

bool Sum::carries_level() const noexcept {
  return std::ranges::any_of(terms_, [](const Term& t) { return t.model->carries_level(); });
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "filters/state_models/sum.h"

#include <utility>

namespace ifog {

Sum::Sum(std::vector<Term> terms) : terms_(std::move(terms)) {
  for (const Term& term : terms_) states_ += term.model->states();
}

void Sum::discretise(double dt_s, StateMatrixRef transition, StateMatrixRef driving) const noexcept {
  transition.setZero();
  driving.setZero();
  int first = 0;
  for (const Term& term : terms_) {
    const int n = term.model->states();
    term.model->discretise(dt_s, transition.block(first, first, n, n), driving.block(first, first, n, n));
    driving.block(first, first, n, n) *= term.noise_ratio;
    first += n;
  }
}

Eigen::VectorXd Sum::measurement() const {
  Eigen::VectorXd all(states_);
  int first = 0;
  for (const Term& term : terms_) {
    all.segment(first, term.model->states()) = term.model->measurement();
    first += term.model->states();
  }
  return all;
}

Eigen::VectorXd Sum::rate() const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(states_);
  int first = 0;
  for (const Term& term : terms_) {
    const int n = term.model->states();
    if (is_rate(term, first)) all.segment(first, n) = term.model->rate();
    first += n;
  }
  return all;
}

Eigen::MatrixXd Sum::colour() const {
  Eigen::MatrixXd all = stationary();
  int first = 0;
  for (const Term& term : terms_) {
    const int n = term.model->states();
    if (is_rate(term, first)) all.block(first, first, n, n).setZero();
    first += n;
  }
  return all;
}

Eigen::VectorXd Sum::level() const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(states_);
  int first = 0;
  int carrier = 0;  // first term, unless a later one carries the level
  const StateModel* model = terms_.front().model.get();
  for (const Term& term : terms_) {
    if (term.model->carries_level() && !model->carries_level()) {
      model = term.model.get();
      carrier = first;
    }
    first += term.model->states();
  }
  all.segment(carrier, model->states()) = model->level();
  return all;
}

bool Sum::carries_level() const noexcept {
  for (const Term& term : terms_) {
    if (term.model->carries_level()) return true;
  }
  return false;
}

Eigen::MatrixXd Sum::stationary() const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(states_, states_);
  int first = 0;
  for (const Term& term : terms_) {
    const int n = term.model->states();
    all.block(first, first, n, n) = term.noise_ratio * term.model->stationary();
    first += n;
  }
  return all;
}

Eigen::VectorXd Sum::diffuse() const {
  Eigen::VectorXd all(states_);
  int first = 0;
  for (const Term& term : terms_) {
    all.segment(first, term.model->states()) = term.model->diffuse();
    first += term.model->states();
  }
  return all;
}

Eigen::VectorXd Sum::start() const {
  Eigen::VectorXd all(states_);
  int first = 0;
  for (const Term& term : terms_) {
    all.segment(first, term.model->states()) = term.model->start();
    first += term.model->states();
  }
  return all;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "filters/state_models/state_model.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "filters/state_models/arma.h"
#include "filters/state_models/gauss_markov.h"
#include "filters/state_models/harmonic.h"
#include "filters/state_models/random_walk.h"
#include "filters/state_models/state_name.h"
#include "filters/state_models/sum.h"

namespace ifog {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& expected) {
  throw std::invalid_argument("state: " + in_quotes(name) + ", expected " + expected);
}

// Hands out parameters in order.
class ParameterReader {
 public:
  ParameterReader(const std::string& name, std::span<const double> values) : name_(name), values_(values) {}
  double take(const char* what) {
    if (used_ == values_.size()) {
      refuse(name_, "one more value in state_parameters (" + std::to_string(used_) + " given): " + what);
    }
    const double value = values_[used_++];
    if (!std::isfinite(value)) refuse(name_, std::string("a finite state_parameter: ") + what);
    return value;
  }
  double take_positive(const char* what) {
    const double value = take(what);
    if (!(value > 0)) refuse(name_, std::string("a positive state_parameter: ") + what);
    return value;
  }
  void finish() const {
    if (used_ != values_.size()) {
      refuse(name_, std::to_string(used_) + " state_parameters, not " + std::to_string(values_.size()));
    }
  }

 private:
  const std::string& name_;
  std::span<const double> values_;
  std::size_t used_ = 0;
};

std::unique_ptr<StateModel> make_term(const std::string& term, ParameterReader& parameters, double period_s) {
  if (term == "random-walk") return std::make_unique<RandomWalk>();
  if (term == "integrated-random-walk") return std::make_unique<IntegratedRandomWalk>(period_s);
  if (term == "gauss-markov")
    return std::make_unique<GaussMarkov>(parameters.take_positive("correlation time in s"));
  if (term == "harmonic") return std::make_unique<Harmonic>(parameters.take_positive("frequency in Hz"));
  if (const auto arma = arma_orders(term)) {
    const auto [p, q] = *arma;
    if (p > kMaxStates || q > kMaxStates - 1 || p + q < 1) {
      refuse(term, "at least one coefficient and at most " + std::to_string(kMaxStates) + " states");
    }
    std::vector<double> phi, theta;
    for (int i = 0; i < p; ++i) phi.push_back(parameters.take("autoregressive coefficient"));
    for (int i = 0; i < q; ++i) theta.push_back(parameters.take("moving-average coefficient"));
    return std::make_unique<Arma>(std::move(phi), std::move(theta), period_s);
  }
  refuse(term, expected_state_model(term));
}

}  // namespace

std::vector<std::string> state_model_names() {
  return {"random-walk", "integrated-random-walk", "gauss-markov", "ar(p)", "arma(p,q)", "harmonic"};
}

std::string expected_state_model(const std::string& written) {
  return one_of(written, state_model_names(), ", or a sum of them with ' + '");
}

std::vector<std::string> terms_of(const std::string& name) {
  constexpr std::string_view kPlus = " + ";
  std::vector<std::string> terms;
  for (std::size_t from = 0; from <= name.size();) {
    const std::size_t to = std::min(name.find(kPlus, from), name.size());
    terms.push_back(name.substr(from, to - from));
    from = to + kPlus.size();
  }
  return terms;
}

std::optional<std::pair<int, int>> arma_orders(const std::string& term) {
  const auto behind = [&](char sign) {
    unsigned value = 0;
    const std::size_t at = std::min(term.find(sign), term.size() - 1) + 1;
    std::from_chars(term.data() + at, term.data() + term.size(), value);
    return static_cast<int>(std::min(value, 1000U));
  };
  const int p = behind('('), q = behind(',');
  if (term == "ar(" + std::to_string(p) + ")") return std::pair{p, 0};
  if (term == "arma(" + std::to_string(p) + "," + std::to_string(q) + ")") return std::pair{p, q};
  return std::nullopt;
}

bool is_state_model(const std::string& name) {
  constexpr std::array kPlain{"random-walk", "integrated-random-walk", "gauss-markov", "harmonic"};
  return std::ranges::all_of(terms_of(name), [&](const std::string& term) {
    return std::find(kPlain.begin(), kPlain.end(), term) != kPlain.end() || arma_orders(term);
  });
}

std::unique_ptr<StateModel> make_state_model(const std::string& name, std::span<const double> parameters,
                                             double nominal_period_s) {
  ParameterReader reader(name, parameters);
  std::vector<Sum::Term> terms;
  for (const std::string& each : terms_of(name)) {
    Sum::Term term;
    term.model = make_term(each, reader, nominal_period_s);
    if (!terms.empty()) {
      term.noise_ratio = reader.take("driving noise of the term over process_noise");
      if (term.noise_ratio < 0) refuse(name, "a driving noise ratio of at least 0");
    }
    terms.push_back(std::move(term));
  }
  reader.finish();
  std::unique_ptr<StateModel> model;
  if (terms.size() == 1) {
    model = std::move(terms.front().model);
  } else {
    model = std::make_unique<Sum>(std::move(terms));
  }
  if (model->states() > kMaxStates) {
    refuse(name, "at most " + std::to_string(kMaxStates) + " states, not " + std::to_string(model->states()));
  }
  return model;
}

}  // namespace ifog

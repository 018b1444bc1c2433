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

// "arma(2,1)" -> {2, 1}; empty if the text is not NAME(number[,number]).
std::vector<int> orders(const std::string& text, const std::string& name) {
  std::vector<int> found;
  if (!text.starts_with(name + "(") || !text.ends_with(")")) return {};
  const char* at = text.data() + name.size() + 1;
  const char* const end = text.data() + text.size() - 1;
  while (at < end) {
    int value = 0;
    const auto [rest, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || value < 0 || (rest != end && *rest != ',')) return {};
    found.push_back(value);
    at = rest == end ? end : rest + 1;
  }
  return found;
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
  const std::vector<int> ar = orders(term, "ar");
  const std::vector<int> arma = orders(term, "arma");
  if (ar.size() == 1 || arma.size() == 2) {
    const int p = arma.empty() ? ar[0] : arma[0];
    const int q = arma.empty() ? 0 : arma[1];
    if (p + q < 1 || p > kMaxStates || q > kMaxStates - 1) {
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

bool is_state_model(const std::string& name) {
  constexpr std::string_view kPlus = " + ";
  constexpr std::array kPlain{"random-walk", "integrated-random-walk", "gauss-markov", "harmonic"};
  for (std::size_t from = 0; from <= name.size();) {
    const std::size_t to = std::min(name.find(kPlus, from), name.size());
    const std::string term = name.substr(from, to - from);
    if (std::find(kPlain.begin(), kPlain.end(), term) == kPlain.end() && orders(term, "ar").size() != 1 &&
        orders(term, "arma").size() != 2)
      return false;
    from = to + kPlus.size();
  }
  return true;
}

std::unique_ptr<StateModel> make_state_model(const std::string& name, std::span<const double> parameters,
                                             double nominal_period_s) {
  constexpr std::string_view kPlus = " + ";
  ParameterReader reader(name, parameters);
  std::vector<Sum::Term> terms;
  for (std::size_t from = 0; from <= name.size();) {
    const std::size_t to = std::min(name.find(kPlus, from), name.size());
    Sum::Term term;
    term.model = make_term(name.substr(from, to - from), reader, nominal_period_s);
    if (!terms.empty()) {
      term.noise_ratio = reader.take("driving noise of the term over process_noise");
      if (term.noise_ratio < 0) refuse(name, "a driving noise ratio of at least 0");
    }
    terms.push_back(std::move(term));
    from = to + kPlus.size();
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

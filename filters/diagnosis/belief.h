// What a diagnosis leaves open: the noise parameters that the record allows, and other explanations of the
// same error. Predictions average over both.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/model_file/model.h"

namespace ifog {

struct NoiseBelief {
  struct Part {
    double weight = 0.0;    // of all parts: sum to one
    double white = 0.0;     // variance of a mean of one second, (rad/s)^2 s
    double walk = 0.0;      // growth of the random walk's variance, (rad/s)^2/s
    double flicker = 0.0;   // variance of each Gauss-Markov process of the bank, (rad/s)^2
    double markov = 0.0;    // of one process of its own
    double markov_s = 0.0;  // its time constant
  };
  std::vector<Part> parts;
  std::vector<double> flicker_s;  // time constants of the bank
};

// A bias that depends on which way a channel came, and that no form corrects; see hysteresis.h.
struct Hysteresis {
  std::string channel;
  double half_width = 0.0;   // of the play, in the channel's unit
  double coefficient = 0.0;  // rad/s per unit of the channel
  double likelihood_ratio = 0.0;
};

// All effects, with one of them replaced by what it cannot be told from.
struct OtherExplanation {
  std::vector<Effect> effects;
  double weight = 0.0;  // likelihood beside that of the effects reported
  std::optional<Hysteresis> hysteresis;
};

}  // namespace ifog

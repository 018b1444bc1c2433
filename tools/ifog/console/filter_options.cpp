#include "tools/ifog/console/filter_options.h"

#include <CLI/CLI.hpp>

namespace ifog::tools {

void add_filter_options(CLI::App& app, FilterChoice& choice, bool with_rule) {
  const std::string group = "Filter";
  if (with_rule)
    app.add_option("--filter", choice.rule,
                   "adaptation rule: ckf, irwe-akfg, iae, rae, mmae, sage-husa or vb")
        ->group(group);
  app.add_option("--state", choice.state,
                 "state model: random-walk, integrated-random-walk, gauss-markov, ar, …")
      ->group(group);
  app.add_option("--state-parameter", choice.state_parameters,
                 "parameters of the state model, in its own order")
      ->delimiter(',')
      ->group(group);
  app.add_option("--process-noise", choice.process_noise, "driving noise of the state, (rad/s)^2/s")
      ->check(CLI::PositiveNumber)
      ->group(group);
  app.add_option("--measurement-noise", choice.measurement_noise, "variance of one sample, (rad/s)^2")
      ->check(CLI::PositiveNumber)
      ->group(group);
  app.add_option("--window", choice.window, "innovations in the adaptive window")
      ->check(CLI::Range(2, 4096))
      ->group(group);
  app.add_option("--weights", choice.weights, "random weights of irwe-akfg")
      ->check(CLI::IsMember({"kept", "fresh", "uniform"}))
      ->group(group);
  app.add_option("--draws", choice.draws, "weight draws averaged at each step")
      ->check(CLI::Range(1, 64))
      ->group(group);
  app.add_option("--floor", choice.floor, "floor of the innovation covariance in parts of R; 0: none")
      ->check(CLI::NonNegativeNumber)
      ->group(group);
  app.add_option("--seed", choice.seed, "of the random weights")->group(group);
  app.add_flag_callback(
         "--no-follow", [&choice] { choice.follow_manoeuvres = false; },
         "do not raise the gain after a change of rate")
      ->group(group);
  app.add_flag_callback(
         "--no-conserve", [&choice] { choice.conserve_angle = false; },
         "do not return the integral of denoised - compensated to zero")
      ->group(group);
}

}  // namespace ifog::tools

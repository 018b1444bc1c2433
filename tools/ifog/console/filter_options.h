// The options that say which filter: the same names in `denoise`, `compare` and `tune`, read into the same
// structure the daemon's configuration is read into.
#pragma once

#include <string>

#include "filters/chain/filter_choice.h"

namespace CLI {
class App;
}

namespace ifog::tools {

// Adds --filter, --state, --process-noise, --measurement-noise, --state-parameter, --window, --weights,
// --draws,
// --floor, --seed, --no-follow and --no-conserve. `choice` must outlive the parse. `with_rule`: --filter too.
void add_filter_options(CLI::App& app, FilterChoice& choice, bool with_rule = true);

}  // namespace ifog::tools

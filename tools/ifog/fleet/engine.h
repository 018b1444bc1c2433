// SPDX-License-Identifier: Apache-2.0
// Who runs the processes of a fleet, one a gyro: the processors of this machine, or Slurm. Both start the
// same command, `ifog fleet --one INDEX MANIFEST …`, and what comes of it stands in the results alone.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/ifog/fleet/results.h"

namespace ifog::tools {

class Engine {
 public:
  Engine() = default;
  virtual ~Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  // Processes for these gyros of the manifest, started and waited for. For those that failed the last
  // word on how, where it is known. done: called now and then with how many have ended. Throws Failed when
  // interrupted, std::runtime_error with one line when none can be started.
  virtual std::map<std::size_t, std::string> run(const std::vector<std::size_t>& gyros,
                                                 const std::function<void(std::size_t)>& done) = 0;

  // What run() would start, for a person or a shell.
  [[nodiscard]] virtual std::string in_words(const std::vector<std::size_t>& gyros) const = 0;
};

// jobs: at once; 0: as many as there are processors.
std::unique_ptr<Engine> local_engine(const Results& results, std::size_t jobs);

// jobs: at once; 0: as many as Slurm gives. Partition, memory and time are Slurm's to know: by its defaults
// and the environment of sbatch (SBATCH_PARTITION, SBATCH_TIMELIMIT, SBATCH_MEM_PER_CPU).
std::unique_ptr<Engine> slurm_engine(const Results& results, std::size_t jobs);

// The command for one gyro. Its index stands before all that was typed, where a `--` ends the options.
std::vector<std::string> command_for_one(const std::string& index);

// The same for a shell, all but `index` in quotes where they are needed.
std::string shell_command_for_one(const std::string& index);

}  // namespace ifog::tools

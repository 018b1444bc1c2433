// SPDX-License-Identifier: Apache-2.0
// Starts the processes of a fleet, one per gyro, on this computer or with Slurm. Both run `ifog fleet --one
// INDEX MANIFEST …`, whose only output is the results folder.
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

  // Runs a process for each of these gyros and waits. Returns the last message of those that failed, if
  // known. done: called with the number of ended processes. Throws Failed if interrupted, std::runtime_error
  // with one line if none can be started.
  virtual std::map<std::size_t, std::string> run(const std::vector<std::size_t>& gyros,
                                                 const std::function<void(std::size_t)>& done) = 0;

  // The command that run() would start, for a person or a shell.
  [[nodiscard]] virtual std::string in_words(const std::vector<std::size_t>& gyros) const = 0;
};

// name: "local", "slurm", or "auto", which takes Slurm where it answers. jobs: in parallel; 0: one per processor,
// with Slurm no limit. Its partition, memory and time are set by Slurm's defaults and the environment of sbatch
// (SBATCH_PARTITION, SBATCH_TIMELIMIT, SBATCH_MEM_PER_CPU).
std::unique_ptr<Engine> engine_named(const std::string& name, const Results& results, std::size_t jobs);

}  // namespace ifog::tools

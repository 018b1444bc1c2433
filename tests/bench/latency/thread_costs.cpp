// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/latency/thread_costs.h"

#include <filesystem>
#include <fstream>
#include <sstream>

namespace ifog {
namespace {

// proc(5): the tenth field; here the first one is the second after the name in parentheses.
std::uint64_t minor_faults(const std::filesystem::path& task) {
  std::string line;
  std::getline(std::ifstream(task / "stat"), line);
  std::istringstream behind_the_name(line.substr(line.rfind(')') + 1));
  std::string word;
  for (int field = 3; field <= 10; ++field) behind_the_name >> word;
  return std::stoull(word);
}

}  // namespace

ThreadCosts costs_of_threads(const std::string& name) {
  ThreadCosts out;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string word;
    if (std::getline(std::ifstream(task.path() / "comm"), word); word != name) continue;
    ThreadCosts one;
    one.faults = minor_faults(task.path());
    for (std::ifstream status(task.path() / "status"); status >> word;) {
      if (word == "voluntary_ctxt_switches:") status >> one.slept;
      if (word == "nonvoluntary_ctxt_switches:") status >> one.preempted;
    }
    out += one;
  }
  return out;
}

}  // namespace ifog

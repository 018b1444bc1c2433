// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <iterator>
#include <thread>

#include "drivers/system/shell_word.h"
#include "tools/ifog/console/command_line.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/interrupt.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/fleet/engine.h"
#include "tools/ifog/fleet/process.h"

namespace ifog::tools {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{20};

class LocalEngine : public Engine {
 public:
  LocalEngine(const Results& results, std::size_t jobs)
      : results_(results),
        jobs_(jobs > 0 ? jobs : std::max<std::size_t>(1, std::thread::hardware_concurrency())) {}

  // Ends the children if run() throws.
  ~LocalEngine() override { end_all(); }

  std::map<std::size_t, std::string> run(const std::vector<std::size_t>& gyros,
                                         const std::function<void(std::size_t)>& done) override {
    ended_.clear();
    for (std::size_t next = 0; next < gyros.size() || !running_.empty();) {
      if (interrupted()) {
        end_all();
        warn("ifog: interrupted; the same command takes up what is missing\n");
        throw Failed("interrupted");
      }
      while (next < gyros.size() && running_.size() < jobs_) begin(gyros[next++]);
      if (!collect()) std::this_thread::sleep_for(kBetweenLooks);
      done(next - running_.size());
    }
    return ended_;
  }

  [[nodiscard]] std::string in_words(const std::vector<std::size_t>& gyros) const override {
    std::string text;
    for (const std::size_t gyro : gyros) {
      text += shell_command_for_one(std::to_string(gyro)) + "\n";
    }
    return text;
  }

 private:
  void begin(std::size_t gyro) {
    running_[start(command_for_one(std::to_string(gyro)), results_.log(gyro))] = gyro;
  }

  // True if a process has ended.
  bool collect() {
    for (auto at = running_.begin(); at != running_.end(); ++at) {
      int status = 0;
      if (waitpid(at->first, &status, WNOHANG) != at->first) continue;
      if (const std::string how = ending(status); !how.empty()) ended_[at->second] = how;
      running_.erase(at);
      return true;
    }
    return false;
  }

  void end_all() {
    for (const auto& [child, gyro] : running_) kill(child, SIGTERM);
    for (const auto& [child, gyro] : running_)
      while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
      }
    running_.clear();
  }

  const Results& results_;
  std::size_t jobs_;
  std::map<pid_t, std::size_t> running_;
  std::map<std::size_t, std::string> ended_;
};

}  // namespace

std::vector<std::string> command_for_one(const std::string& index) {
  std::vector<std::string> words = {own_path()};
  const std::vector<std::string> typed = typed_words();
  const auto end_of_options = std::find(typed.begin(), typed.end(), "--");
  std::copy_if(typed.begin(), end_of_options, std::back_inserter(words),
               [](const std::string& word) { return word != "--dry-run"; });
  words.insert(words.end(), end_of_options, typed.end());
  const auto command = std::find(words.begin() + 1, words.end(), "fleet");
  words.insert(command == words.end() ? command : command + 1, {"--one", index});
  return words;
}

std::string shell_command_for_one(const std::string& index) {
  // Only the position marks the index: other words may be equal to it.
  const std::vector<std::string> words = command_for_one(index);
  const auto place = std::find(words.begin() + 1, words.end(), "--one") + 1;
  std::string text;
  for (auto word = words.begin(); word != words.end(); ++word)
    text += (text.empty() ? "" : " ") + (word == place ? *word : shell_word(*word));
  return text;
}

std::unique_ptr<Engine> local_engine(const Results& results, std::size_t jobs) {
  return std::make_unique<LocalEngine>(results, jobs);
}

}  // namespace ifog::tools

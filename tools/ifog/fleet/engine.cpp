// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/engine.h"

#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <thread>

#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"
#include "filters/model_file/sha256.h"
#include "tools/ifog/console/command_line.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/interrupt.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/fleet/process.h"

namespace ifog::tools {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{20};

// The command for one gyro. The index precedes the typed words, because a `--` there ends the options.
std::vector<std::string> command_for_one(const std::string& index) {
  std::vector<std::string> words = {own_path()};
  const std::vector<std::string> typed = typed_words();
  const auto end_of_options = std::ranges::find(typed, "--");
  std::copy_if(typed.begin(), end_of_options, std::back_inserter(words),
               [](const std::string& word) { return word != "--dry-run"; });
  words.insert(words.end(), end_of_options, typed.end());
  const auto command = std::find(words.begin() + 1, words.end(), "fleet");
  words.insert(command == words.end() ? command : command + 1, {"--one", index});
  return words;
}

// The same for a shell; all words except `index` are quoted where necessary.
std::string shell_command_for_one(const std::string& index) {
  // Only the position marks the index: other words may be equal to it.
  const std::vector<std::string> words = command_for_one(index);
  const auto place = std::find(words.begin() + 1, words.end(), "--one") + 1;
  std::string text;
  for (auto word = words.begin(); word != words.end(); ++word)
    text += (text.empty() ? "" : " ") + (word == place ? *word : shell_word(*word));
  return text;
}

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

using Seconds = std::chrono::duration<double>;

// Slurm's default MaxArraySize is 1001; more gyros need several arrays.
constexpr std::size_t kLargestArray = 1000;
constexpr double kFirstPause_s = 0.5, kLongestPause_s = 15.0;
// Time in which a restarted controller answers again.
constexpr double kPatience_s = 600.0;
// Slurm's own timeouts are shorter; a longer wait means that the network or file system hangs.
constexpr std::chrono::minutes kAnswer{2};

// "0-3,7" from ascending numbers.
std::string ranges_of(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(numbers[i]);
    if (last > i) text += "-" + std::to_string(numbers[last]);
    i = last + 1;
  }
  return text;
}

// Counts lines that are the id of a job or of an array's task, 12 or 12_3; other lines are warnings.
std::size_t jobs_in(const std::string& said) {
  const auto number = [](const std::string& text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  };
  std::size_t jobs = 0;
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    line.erase(line.find_last_not_of(' ') + 1);
    const std::size_t task = line.find('_');
    if (number(line.substr(0, task)) && (task == std::string::npos || number(line.substr(task + 1)))) ++jobs;
  }
  return jobs;
}

std::string first_line(const std::string& text) { return printable(text.substr(0, text.find('\n')), 300); }

std::string how(const Ran& ran) { return ran.ended + (ran.said.empty() ? "" : ": " + first_line(ran.said)); }

class SlurmEngine : public Engine {
 public:
  SlurmEngine(const Results& results, std::size_t jobs)
      : jobs_(jobs),
        folder_(std::filesystem::absolute(results.folder()).lexically_normal().string()),
        name_("ifog-fleet-" + sha256_hex(folder_).substr(0, 12)) {}

  std::map<std::size_t, std::string> run(const std::vector<std::size_t>& gyros,
                                         const std::function<void(std::size_t)>& done) override {
    // Jobs of an interrupted run are not submitted twice.
    if (under_way(0.0) > 0)
      say("waiting for the array {}, which is under way\n", name_);
    else
      for (const std::string& script : scripts(gyros)) submit(script);
    wait(gyros.size(), done);
    return {};
  }

  [[nodiscard]] std::string in_words(const std::vector<std::size_t>& gyros) const override {
    std::string text;
    for (const std::string& script : scripts(gyros)) text += script;
    return text;
  }

 private:
  [[nodiscard]] std::vector<std::string> scripts(const std::vector<std::size_t>& gyros) const {
    std::map<std::size_t, std::vector<std::size_t>> arrays;  // by their first gyro
    for (const std::size_t gyro : gyros)
      arrays[gyro / kLargestArray * kLargestArray].push_back(gyro % kLargestArray);
    std::vector<std::string> texts;
    texts.reserve(arrays.size());
    for (const auto& [first, numbers] : arrays) texts.push_back(script(first, numbers));
    return texts;
  }

  // Contains nothing from the manifest, and each typed word in quotes.
  [[nodiscard]] std::string script(std::size_t first, const std::vector<std::size_t>& numbers) const {
    std::string text = "#!/bin/bash\n#SBATCH --job-name=" + name_ + "\n#SBATCH --array=" + ranges_of(numbers);
    if (jobs_ > 0) text += "%" + std::to_string(jobs_);
    text +=
        "\n#SBATCH --ntasks=1\n#SBATCH --requeue\n#SBATCH --input=/dev/null\n#SBATCH --output=/dev/null\n"
        "gyro=$((" +
        std::to_string(first) + " + SLURM_ARRAY_TASK_ID))\n";
    text += "cd " + shell_word(std::filesystem::current_path().string()) + " || exit 1\n";
    text += "exec >>" + shell_word(folder_ + "/log/") + "\"$gyro.txt\" 2>&1\nexec ";
    return text + shell_command_for_one("\"$gyro\"") + "\n";
  }

  static void submit(const std::string& script) {
    const Ran ran = run_to_end({"sbatch", "--parsable"}, script, kAnswer);
    if (!ran.ended.empty()) throw refusal("sbatch: {}", how(ran));
    say("submitted the array {}\n", first_line(ran.said));
  }

  // Number of this fleet's jobs that have not ended. patience_s: for a Slurm that does not answer.
  std::size_t under_way(double patience_s) {
    const auto since = std::chrono::steady_clock::now();
    for (;;) {
      const Ran ran = run_to_end(
          {"squeue", "--noheader", "--array", "--me", "--name=" + name_, "--format=%i"}, "", kAnswer);
      if (ran.ended.empty()) return jobs_in(ran.said);
      if (Seconds(std::chrono::steady_clock::now() - since).count() >= patience_s)
        throw refusal("squeue: {}", how(ran));
      pause(kFirstPause_s);
    }
  }

  void wait(std::size_t all, const std::function<void(std::size_t)>& done) {
    double pause_s = kFirstPause_s;
    while (const std::size_t left = under_way(kPatience_s)) {
      done(all - std::min(all, left));
      pause(pause_s);
      pause_s = std::min(1.3 * pause_s, kLongestPause_s);
    }
  }

  void pause(double seconds) const {
    const auto until = std::chrono::steady_clock::now() + Seconds(seconds);
    while (std::chrono::steady_clock::now() < until) {
      if (interrupted()) {
        warn(
            "ifog: interrupted; the array {} continues, and the same command takes it up (scancel --name={} "
            "ends it)\n",
            name_, name_);
        throw Failed("interrupted");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }

  std::size_t jobs_;
  std::string folder_, name_;
};

}  // namespace

std::unique_ptr<Engine> engine_named(const std::string& name, const Results& results, std::size_t jobs) {
  // An installed Slurm may have no controller.
  const bool slurm =
      name == "slurm" || (name == "auto" && is_there("sbatch") &&
                          run_to_end({"sinfo", "--noheader"}, "", std::chrono::seconds(10)).ended.empty());
  if (slurm) return std::make_unique<SlurmEngine>(results, jobs);
  return std::make_unique<LocalEngine>(results, jobs);
}

}  // namespace ifog::tools

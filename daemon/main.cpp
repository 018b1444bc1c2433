// SPDX-License-Identifier: Apache-2.0
// ifogd: reads gyros, denoises, publishes. Exit codes: 0 success, 1 failure, 2 usage or configuration error.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <initializer_list>
#include <iostream>
#include <memory>
#include <span>
#include <string>

#include "daemon/config/config.h"
#include "daemon/config/version_text.h"
#include "daemon/housekeeping/housekeeping.h"
#include "daemon/housekeeping/log.h"
#include "daemon/publish/publisher.h"
#include "daemon/state/state_folder.h"
#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/shell_word.h"

namespace {

// For this thread and its later ones.
void block(std::initializer_list<int> signals) {
  sigset_t set;
  sigemptyset(&set);
  for (const int each : signals) sigaddset(&set, each);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

// Opens closed standard streams, so that the log cannot go into a gyro's serial line; and ignores SIGPIPE, so
// that the log's reader cannot end the daemon.
void keep_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", O_RDWR) < 0) std::abort();
  signal(SIGPIPE, SIG_IGN);
}

// Publisher of --check, which opens nothing.
class NowherePublisher final : public ifog::Publisher {
 public:
  bool publish(const char*, std::span<const std::uint8_t>) noexcept override { return false; }
};

std::unique_ptr<ifog::Publisher> publish_nowhere(const std::string&) {
  return std::make_unique<NowherePublisher>();
}

// What is wrong with a word that is no option of this program.
std::string foreign(const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  if (!name.starts_with('-')) return "a configuration is given by --config " + ifog::shell_word(word);
  return "unknown option " + ifog::in_quotes(name) +
         ifog::meant_or_known(name, std::array{"--config", "--check", "--version", "--help"});
}

// Failed if the output could not be written.
int said(int code) {
  std::cout.flush();
  if (std::cout && std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  std::fprintf(stderr, "ifogd: cannot write standard output\n");
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  // First of all: a reload requested while the configuration is read happens after it, an end at once.
  block({SIGHUP});
  keep_standard_streams();
  CLI::App app{"ifogd: real-time daemon for fibre-optic gyros", "ifogd"};
  app.set_version_flag("--version", ifog::version_text("ifogd"));
  std::string file;
  bool check = false;
  app.add_option("--config", file, "configuration (TOML)")->required()->type_name("FILE");
  app.add_flag("--check", check, "say what is wrong with the configuration, open nothing");
  app.allow_extras();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // An unknown word is reported before a missing --config.
    if (app.remaining().empty()) return app.exit(error) == 0 ? said(0) : 2;
  }
  if (const auto words = app.remaining(); !words.empty()) {
    std::fprintf(stderr, "ifogd: %s\n", foreign(words.front()).c_str());
    return 2;
  }
  try {
    ifog::Config config = ifog::read_config(file);
    ifog::set_up_log(config.log_level);
    const std::size_t sensors = config.sensors.size();
    const std::string folder = ifog::state_folder(config.state_folder);
    ifog::Housekeeping housekeeping(std::move(config), check ? publish_nowhere : ifog::make_lcm_publisher);
    if (check) {
      // The state folder may be missing: another user may run the daemon.
      if (const std::string missed = ifog::state_folder_complaint(folder); !missed.empty())
        std::fprintf(stderr, "%s: %s\n", file.c_str(), missed.c_str());
      std::printf("%s: good, %zu sensor(s)\n", file.c_str(), sensors);
      return said(0);
    }
    block({SIGTERM, SIGINT, SIGHUP});
    return housekeeping.run();
  } catch (const ifog::ConfigError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ifogd: %s\n", error.what());
    return 1;
  }
}

// SPDX-License-Identifier: Apache-2.0
// The daemon as a user starts it, in a folder and a network of its own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/unit/daemon/private_network.h"

namespace ifog {

class Ifogd : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("ifogd-test-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    // Nothing here is to be heard outside.
    unreachable_ = enter_private_network();
    if (!unreachable_.empty())
      GTEST_SKIP() << "no private network namespace (" << unreachable_
                   << "); runs as root or with user namespaces";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
  }
  // One sensor that reads flight.kvh, and more.
  void configure(const std::string& more, const std::string& driver = "kvh1750") const {
    write("ifogd.toml", "[daemon]\nlock_memory = false\nplugin_folder = \"" IFOG_REFUSED_PLUGINS
                        "\"\n[[sensor]]\nname = \"nose\"\ndriver = \"" +
                            driver + "\"\n" + more);
  }
  // Its exit status; all it says goes to the file `said`.
  int ifogd(const std::string& arguments = "") const {
    const std::string command = "timeout 60 " IFOG_BINARY_DIR "/daemon/ifogd --config " + path("ifogd.toml") +
                                " " + arguments + " >" + path("said") + " 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  }
  std::vector<std::string> said() const {
    std::ifstream in(path("said"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }
  // How many lines hold it; and the others are shown when it is not the one that was expected.
  int lines_with(const std::string& text) const {
    const std::vector<std::string> all = said();
    return static_cast<int>(std::count_if(all.begin(), all.end(), [&](const std::string& line) {
      return line.find(text) != std::string::npos;
    }));
  }
  std::string all_said() const {
    std::string out;
    for (const std::string& line : said()) out += line + "\n";
    return out;
  }

  std::filesystem::path folder_;
  std::string unreachable_;
};

}  // namespace ifog

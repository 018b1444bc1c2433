// SPDX-License-Identifier: Apache-2.0
// Time from a device's return to its use by a program.
//   usage: device_return DEVICE PROGRAM
//
// Runs until ended: waits for the device's node to disappear and reappear, then for the program to have it
// open, and prints the seconds between both. Checks every millisecond.
#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <string>

namespace {

double now_s() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

bool exists(const std::string& path) {
  struct stat info {};
  return stat(path.c_str(), &info) == 0;
}

// Calls `found` with each name in a folder until it returns true.
bool any_in(const std::string& folder, const std::function<bool(const std::string&)>& found) {
  DIR* const listing = opendir(folder.c_str());
  if (listing == nullptr) return false;
  bool yes = false;
  while (const dirent* entry = yes ? nullptr : readdir(listing)) yes = found(entry->d_name);
  closedir(listing);
  return yes;
}

std::string process_of(const std::string& program) {
  std::string process;
  any_in("/proc", [&](const std::string& name) {
    std::string comm;
    std::getline(std::ifstream("/proc/" + name + "/comm"), comm);
    if (comm == program) process = name;
    return comm == program;
  });
  return process;
}

bool holds(const std::string& process, const std::string& device) {
  const std::string folder = "/proc/" + process + "/fd/";
  return any_in(folder, [&](const std::string& name) {
    std::array<char, PATH_MAX> target{};
    return readlink((folder + name).c_str(), target.data(), target.size() - 1) > 0 && device == target.data();
  });
}

void until(const std::function<bool()>& ready) {
  const timespec step{0, 1'000'000};
  while (!ready()) nanosleep(&step, nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: device_return DEVICE PROGRAM\n", stderr);
    return 2;
  }
  const std::string device = argv[1];
  for (;;) {
    until([&] { return !exists(device); });
    const std::string process = process_of(argv[2]);
    until([&] { return exists(device); });
    const double there_s = now_s();
    until([&] { return holds(process, device); });
    std::printf("%.3f\n", now_s() - there_s);
    std::fflush(stdout);
  }
}

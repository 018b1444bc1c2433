// SPDX-License-Identifier: Apache-2.0
#include "daemon/state/state_folder.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "drivers/ifog/quoted.h"
#include "drivers/system/fd.h"
#include "filters/units/told_time.h"

namespace ifog {

std::string state_folder(const std::string& configured) {
  if (!configured.empty()) return configured;
  const char* const given = std::getenv("STATE_DIRECTORY");
  if (given == nullptr) return "";
  const std::string all = given;
  return all.substr(0, all.find(':'));
}

namespace {

std::string cannot(const std::string& folder, const char* what, const std::string& why) {
  return "daemon.state_folder = \"" + printable(folder, kLongestMessage) + "\": " + what + ": " + why +
         ", expected a folder that the daemon may write, or a path that is free for it";
}

}  // namespace

std::string state_folder_complaint(const std::string& folder) {
  namespace fs = std::filesystem;
  if (folder.empty()) return "";
  std::error_code error;
  fs::path there = folder;
  while (!fs::exists(there, error) && there.has_parent_path() && there != there.parent_path())
    there = there.parent_path();
  if (error || !fs::is_directory(there, error))
    return cannot(folder, "cannot be made",
                  error ? error.message() : std::generic_category().message(ENOTDIR));
  if (::access(there.c_str(), W_OK | X_OK) == 0) return "";
  return cannot(folder, there == fs::path(folder) ? "cannot be written" : "cannot be made",
                std::generic_category().message(errno));
}

std::string make_state_folder(const std::string& folder) {
  if (folder.empty()) return "";
  std::error_code error;
  const bool made = std::filesystem::create_directories(folder, error);
  if (error) return cannot(folder, "cannot be made", error.message());
  // Regardless of the umask, as in systemd/ifogd.service.in: the group stores models there.
  if (made) ::chmod(folder.c_str(), 02775);
  return "";
}

std::string adopted_model_path(const std::string& folder, const std::string& sensor) {
  return (std::filesystem::path(folder) / (sensor + ".model.toml")).string();
}

namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": " + what);
}
std::string reason() { return std::generic_category().message(errno); }

// An open folder and a name in it without slashes, so that O_NOFOLLOW is equivalent to RESOLVE_BENEATH and
// RESOLVE_NO_SYMLINKS of openat2.
struct Place {
  explicit Place(const std::filesystem::path& path)
      : folder(::open(path.has_parent_path() ? path.parent_path().c_str() : ".",
                      O_RDONLY | O_DIRECTORY | O_CLOEXEC)),
        name(path.filename().string()) {}
  const Fd folder;
  const std::string name;
};

// A name that others cannot have prepared.
std::string random_name(const std::string& name) {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != static_cast<ssize_t>(sizeof number))
    throw std::runtime_error("no random numbers: " + reason());
  return "." + name.substr(0, 200) + "." + formatted("%016llx", static_cast<unsigned long long>(number));
}

void write_all(int fd, const std::string& path, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path, "cannot be written: " + reason());
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

void write_state_file(const std::string& path, std::string_view bytes) {
  const Place place(path);
  const Fd& folder = place.folder;
  if (folder < 0) fail(path, "its folder cannot be opened: " + reason());
  struct stat there {};
  if (::fstatat(folder, place.name.c_str(), &there, AT_SYMLINK_NOFOLLOW) == 0 && !S_ISREG(there.st_mode))
    fail(path, "is no regular file, which is not written in a state folder");
  const std::string fresh = random_name(place.name);
  const Fd file(::openat(folder, fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0664));
  if (file < 0) fail(path, "cannot be written: " + reason());
  try {
    write_all(file, path, bytes);
    if (::fsync(file) != 0) fail(path, "cannot be written: " + reason());
    if (::renameat(folder, fresh.c_str(), folder, place.name.c_str()) != 0)
      fail(path, "cannot be put in place: " + reason());
  } catch (...) {
    ::unlinkat(folder, fresh.c_str(), 0);
    throw;
  }
  (void)::fsync(folder);
}

std::optional<std::string> state_file(const std::string& path, std::size_t most) {
  const Place place(path);
  const Fd& folder = place.folder;
  const Fd file(
      folder < 0 ? -1 : ::openat(folder, place.name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file < 0 && (errno == ENOENT || errno == ENOTDIR)) return std::nullopt;
  if (file < 0)
    fail(path,
         errno == ELOOP ? "is a link, expected a file of the state folder" : "cannot be read: " + reason());
  struct stat there {
  }, holder{};
  if (::fstat(file, &there) != 0 || ::fstat(folder, &holder) != 0 || !S_ISREG(there.st_mode))
    fail(path, "is no regular file, expected one of the state folder");
  if (there.st_nlink > 1) fail(path, "has other names, expected a file of the state folder alone");
  if (there.st_uid != 0 && there.st_uid != ::geteuid() && there.st_uid != holder.st_uid &&
      there.st_gid != holder.st_gid)
    fail(path, "belongs to a user who has no part in its folder");
  std::string text;
  std::array<char, 65536> piece;
  for (;;) {
    const ssize_t count = ::read(file, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path, "cannot be read: " + reason());
    if (count == 0) return text;
    text.append(piece.data(), static_cast<std::size_t>(count));
    if (text.size() > most)
      fail(path, "is longer than " + std::to_string(most) + " bytes, which no file of the state folder is");
  }
}

std::string read_state_file(const std::string& path, std::size_t most) {
  std::optional<std::string> text = state_file(path, most);
  if (!text) fail(path, "is not there, expected a file of the state folder");
  return *std::move(text);
}

bool is_in_state_folder(const std::string& path) {
  struct stat there {};
  return ::lstat(path.c_str(), &there) == 0;
}

void remove_state_file(const std::string& path) {
  const Place place(path);
  const Fd& folder = place.folder;
  if (folder < 0 || (::unlinkat(folder, place.name.c_str(), 0) != 0 && errno != ENOENT))
    fail(path, "cannot remove: " + reason());
}

std::vector<std::string> names_in_state_folder(const std::string& folder) {
  std::vector<std::string> out;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    out.push_back(entry.path().filename().string());
  if (error && error != std::errc::no_such_file_or_directory)
    throw std::runtime_error(folder + ": cannot read: " + error.message());
  std::sort(out.begin(), out.end());
  return out;
}

std::string without_content(const std::string& path, const std::exception& error) {
  std::string_view said = error.what();
  std::string line;
  if (said.starts_with(path + ":")) {
    said.remove_prefix(path.size());
    line = said.substr(0, std::min(said.find_first_not_of("0123456789", 1), said.size()));
  }
  return path + (line.size() > 1 ? line : "") +
         ": is damaged or of another version (its content is not shown, as others may write this file)";
}

}  // namespace ifog

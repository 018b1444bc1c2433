// SPDX-License-Identifier: Apache-2.0
#include "drivers/host/plugin.h"

#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <link.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <system_error>

#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/fd.h"

namespace ifog {
namespace {

namespace fs = std::filesystem;

template <typename Header>
bool read_at(int fd, std::uint64_t offset, Header& out) {
  return pread(fd, &out, sizeof out, static_cast<off_t>(offset)) == static_cast<ssize_t>(sizeof out);
}

std::string who_may_write(const std::string& path, const struct stat& info) {
  if ((info.st_mode & S_IWOTH) != 0)
    return "anybody may write it, expected a file that only its owner may change";
  const fs::path folder = fs::absolute(path).parent_path();
  struct stat holder {};
  // The sticky bit protects files against replacement.
  if (stat(folder.c_str(), &holder) == 0 && (holder.st_mode & S_IWOTH) != 0 &&
      (holder.st_mode & S_ISVTX) == 0)
    return "anybody may write its folder, expected one that only its owner may change";
  return "";
}

bool whole(int file, std::uint64_t size) {
  ElfW(Ehdr) header{};
  constexpr unsigned char kClass = sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32;
  if (!read_at(file, 0, header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 ||
      header.e_ident[EI_CLASS] != kClass || header.e_phentsize != sizeof(ElfW(Phdr)))
    return true;
  for (unsigned i = 0; i < header.e_phnum; ++i) {
    ElfW(Phdr) segment{};
    if (!read_at(file, header.e_phoff + std::uint64_t{i} * sizeof segment, segment)) return false;
    if (segment.p_type != PT_LOAD) continue;
    if (segment.p_offset > size || segment.p_filesz > size - segment.p_offset) return false;
  }
  return true;
}

// Checks a shared object before dlopen(), which maps what the headers promise and gets SIGBUS beyond the file's
// end. "" or the reason, in one line without the path. Files that are not ELF of this word length pass, as the
// linker reports them.
std::string object_flaw(const std::string& path) {
  // Non-blocking: a FIFO is rejected without waiting.
  const Fd file(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  struct stat info {};
  if (file < 0 || fstat(file, &info) != 0) return "cannot load: " + std::generic_category().message(errno);
  if (!S_ISREG(info.st_mode)) return "is no regular file";
  if (std::string flaw = who_may_write(path, info); !flaw.empty()) return flaw;
  if (!whole(file, static_cast<std::uint64_t>(info.st_size)))
    return "cannot load: shorter than its headers say (is the file cut off?)";
  return "";
}

// First missing required function, or null.
const char* missing_function(const ifog_driver& table) {
  if (table.options == nullptr) return "options";
  for (const ifog_option* option = table.options; option->key != nullptr; ++option)
    if (option->values == nullptr || option->help == nullptr) return "values and help of an option";
  if (table.create == nullptr) return "create";
  if (table.destroy == nullptr) return "destroy";
  if (table.describe == nullptr) return "describe";
  if (table.reset == nullptr) return "reset";
  if (table.counters == nullptr) return "counters";
  if ((table.transports & IFOG_TRANSPORT_BYTES) != 0 && table.decode_bytes == nullptr) return "decode_bytes";
  if ((table.transports & IFOG_TRANSPORT_CAN) != 0 && table.decode_can == nullptr) return "decode_can";
  if ((table.transports & (IFOG_TRANSPORT_BYTES | IFOG_TRANSPORT_CAN)) == 0) return "transports";
  return nullptr;
}

std::vector<fs::path> objects_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".so") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

// Folder `plugins` of the build tree that contains the running program, detected by its CMakeCache.txt; empty
// for an installed program. So no build path is in an installed program.
fs::path build_tree_folder(const fs::path& program) {
  constexpr int kDeepest = 5;
  fs::path folder = program.parent_path();
  std::error_code ignored;
  for (int up = 0; up < kDeepest && folder.has_relative_path(); ++up, folder = folder.parent_path())
    if (fs::exists(folder / "CMakeCache.txt", ignored)) return folder / "plugins";
  return {};
}

}  // namespace

std::shared_ptr<const Plugin> Plugin::load(const std::string& path) {
  const auto refuse = [&](const std::string& why) -> void { throw std::runtime_error(path + ": " + why); };
  if (const std::string flaw = object_flaw(path); !flaw.empty()) refuse(flaw);
  // dlopen() searches a path without a slash in the library path.
  void* handle = dlopen(fs::absolute(path).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) refuse(std::string("cannot load: ") + dlerror());
  const std::shared_ptr<Plugin> plugin(new Plugin(path, handle));
  using Entry = const ifog_driver* (*)();
  const Entry entry = reinterpret_cast<Entry>(dlsym(handle, "ifog_driver_entry"));
  if (entry == nullptr) refuse("is no ifogd plugin: it has no function ifog_driver_entry");
  const ifog_driver* table = entry();
  if (table == nullptr) refuse("ifog_driver_entry returned no table");
  // Checked first: with another version no other field is valid.
  if (table->abi != IFOG_DRIVER_ABI)
    refuse("built for interface version " + std::to_string(table->abi) + ", this program has version " +
           std::to_string(IFOG_DRIVER_ABI) + "; build the plugin against this version");
  if (table->name == nullptr || fs::path(path).stem() != table->name)
    refuse("calls itself " + in_quotes(table->name == nullptr ? "" : table->name) +
           ", expected the name of its file");
  if (const char* missing = missing_function(*table))
    refuse(std::string("its table lacks '") + missing + "'");
  plugin->table_ = table;
  return plugin;
}

Plugin::~Plugin() { dlclose(handle_); }

std::vector<std::string> plugin_folders(const std::vector<std::string>& first) {
  std::vector<std::string> folders = first;
  std::error_code ignored;
  const auto add = [&](const fs::path& folder) {
    if (!folder.empty() && fs::is_directory(folder, ignored) &&
        std::find(folders.begin(), folders.end(), folder.string()) == folders.end())
      folders.push_back(folder.string());
  };
  if (const char* path = secure_getenv("IFOG_PLUGIN_PATH")) {
    std::string_view rest(path);
    while (!rest.empty()) {
      const std::size_t colon = rest.find(':');
      add(rest.substr(0, colon));
      rest.remove_prefix(colon == std::string_view::npos ? rest.size() : colon + 1);
    }
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  if (!program.empty()) {
    add(build_tree_folder(program));
    add(program.parent_path().parent_path() / IFOG_PLUGIN_FOLDER_IN_PREFIX);
  }
  add(IFOG_PLUGIN_FOLDER);
  return folders;
}

std::shared_ptr<const Plugin> find_plugin(const std::string& name, const std::vector<std::string>& folders) {
  std::error_code ignored;
  std::set<std::string> known;
  std::string searched;
  for (const std::string& folder : folders) {
    // Names with a slash would leave the folder.
    const fs::path file = fs::path(folder) / (name + ".so");
    if (name.find('/') == std::string::npos && fs::exists(file, ignored)) return Plugin::load(file.string());
    for (const fs::path& object : objects_in(folder)) known.insert(object.stem().string());
    searched += (searched.empty() ? "" : ", ") + folder;
  }
  throw std::runtime_error("driver is " + in_quotes(name) +
                           (known.empty() ? ", and there is none" : meant_or_known(name, known)) +
                           " (looked in " + (searched.empty() ? "no folder: none exists" : searched) + ")");
}

std::vector<FoundPlugin> list_plugins(const std::vector<std::string>& folders) {
  std::vector<FoundPlugin> found;
  std::set<std::string> names;
  for (const std::string& folder : folders) {
    for (const fs::path& object : objects_in(folder)) {
      FoundPlugin entry;
      entry.path = object.string();
      entry.hidden = !names.insert(object.stem().string()).second;
      try {
        entry.plugin = Plugin::load(entry.path);
      } catch (const std::runtime_error& error) {
        entry.refusal = error.what();
      }
      found.push_back(std::move(entry));
    }
  }
  return found;
}

}  // namespace ifog

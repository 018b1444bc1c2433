// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/command_files.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "drivers/capture/files/file_kind.h"
#include "drivers/capture/files/output_file.h"
#include "drivers/ifog/quoted.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

struct CommandFile {
  std::string option;
  FileIdentity identity;
  bool written;
  std::string path;
};

std::vector<CommandFile> files;

void add(const std::string& option, const std::string& path, bool written) {
  std::optional<FileIdentity> identity = file_identity(path == "-" && !written ? "/dev/stdin" : path);
  if (!identity) return;
  const auto same = std::ranges::find_if(files, [&](const CommandFile& other) {
    return (other.written || written) && other.identity == *identity;
  });
  if (same != files.end())
    throw WrongUsage(option, "is " + in_quotes(path, kLongestMessage) + ", the file that " + same->option +
                                 (same->written ? " writes" : " reads") + "; expected another one");
  files.push_back({option, *std::move(identity), written, path});
}

}  // namespace

void will_read(const std::string& option, const std::string& path) {
  if (path.empty()) return;
  std::error_code none;
  if (!std::filesystem::is_directory(path, none)) return add(option, path, false);
  for (const auto& entry : std::filesystem::directory_iterator(path, none))
    if (entry.path().extension() == ".ifr") add(option, entry.path().string(), false);
}

void will_write(const std::string& option, const std::string& path,
                std::span<const std::string_view> endings) {
  if (path.empty()) return;
  if (is_standard_output(path)) data_to_standard_output(option);
  add(option, path, true);
  expect_writable(path);
  if (!endings.empty()) expect_no_other_kind(option, path, endings);
}

std::string written_in_words() {
  std::string words;
  for (const CommandFile& file : files)
    if (file.written) words += (words.empty() ? "wrote " : ", ") + printable(file.path, kLongestMessage);
  return words;
}

void forget_written_files() { files.clear(); }

void expect_no_other_kind(const std::string& option, const std::string& path,
                          std::span<const std::string_view> endings) {
  constexpr std::string_view kKnown[] = {
      ".csv", ".h5",   ".hdf5", ".mat", ".npy",  ".npz",   ".log",    ".candump", ".lcm",  ".ifr",
      ".bin", ".kvh",  ".raw",  ".dat", ".json", ".jsonl", ".ndjson", ".toml",    ".yaml", ".yml",
      ".xml", ".html", ".htm",  ".md",  ".txt",  ".pdf",   ".doc",    ".docx",    ".odt",  ".rtf",
      ".tex", ".xls",  ".xlsx", ".ods", ".svg",  ".png",   ".jpg",    ".jpeg",    ".gif",  ".webp",
      ".ps",  ".eps",  ".zip",  ".bz2", ".xz",   ".zst",   ".tar",    ".tgz"};
  if (path.empty() || is_standard_output(path) || !file_identity(path)) return;
  const auto says = [name = unpacked_name(path)](std::string_view ending) {
    return boost::iends_with(name, ending);
  };
  if (std::ranges::any_of(endings, says) || std::none_of(std::begin(kKnown), std::end(kKnown), says)) return;
  throw WrongUsage(option, "is " + in_quotes(path, kLongestMessage) + ", expected a name ending in " +
                               std::string(endings.front()));
}

void expect_ending(const std::string& option, const std::string& path, bool known,
                   const std::string& expected) {
  if (known || path.empty() || is_standard_output(path) || !file_identity(path)) return;
  if (!std::filesystem::path(path).has_extension()) return;
  throw WrongUsage(option,
                   "is " + in_quotes(path, kLongestMessage) + ", expected a name ending in " + expected);
}

}  // namespace ifog::tools

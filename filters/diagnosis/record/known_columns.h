// SPDX-License-Identifier: Apache-2.0
// What was worked out of the columns that the axes of a sensor have in common, for the axes that ask for the
// same: each would read through every channel for itself.
#pragma once

#include <compare>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

namespace ifog {

class KnownColumns {
 public:
  // What is asked for, of which column, and by what it is asked for: the same is the same answer.
  struct Asked {
    std::string_view what;  // a literal; one kind of value each
    std::span<const double> column;
    double by = 0.0;
    std::size_t times = 0;
  };

  // A column that does not change and outlives this. Before anybody asks.
  void add(std::span<const double> column) { columns_.insert({column.data(), column.size()}); }

  // work(), or what that gave before; of a column that was not added each time anew. Several threads may ask
  // at once, and one of them works.
  template <typename Work>
  auto of(const Asked& asked, const Work& work) {
    using Value = std::remove_cvref_t<decltype(work())>;
    if (!columns_.contains({asked.column.data(), asked.column.size()}))
      return std::make_shared<const Value>(work());
    Entry& entry = entry_of(asked);
    const std::lock_guard lock(entry.guard);
    if (!entry.value) entry.value = std::make_shared<const Value>(work());
    return std::static_pointer_cast<const Value>(entry.value);
  }

  // So that of() has it: unless it has, or somebody else is at work on it. Who wants several columns asks for
  // all of them so first, and waits for none while there is another to be worked out.
  template <typename Work>
  void prepare(const Asked& asked, const Work& work) {
    using Value = std::remove_cvref_t<decltype(work())>;
    if (!columns_.contains({asked.column.data(), asked.column.size()})) return;
    Entry& entry = entry_of(asked);
    const std::unique_lock lock(entry.guard, std::try_to_lock);
    if (lock.owns_lock() && !entry.value) entry.value = std::make_shared<const Value>(work());
  }

 private:
  using Column = std::pair<const double*, std::size_t>;
  struct Key {
    std::string_view what;
    Column column;
    double by;
    std::size_t times;
    // It is compared with a 0 that is no pointer. NOLINTNEXTLINE(modernize-use-nullptr)
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  struct Entry {
    std::mutex guard;
    std::shared_ptr<const void> value;
  };

  Entry& entry_of(const Asked& asked) {
    const std::lock_guard lock(guard_);
    return entries_[{asked.what, {asked.column.data(), asked.column.size()}, asked.by, asked.times}];
  }

  std::set<Column> columns_;
  std::mutex guard_;
  std::map<Key, Entry> entries_;
};

// known: null where each asks for itself.
template <typename Work>
auto known_or(KnownColumns* known, const KnownColumns::Asked& asked, const Work& work) {
  using Value = std::remove_cvref_t<decltype(work())>;
  return known != nullptr ? known->of(asked, work) : std::make_shared<const Value>(work());
}

}  // namespace ifog

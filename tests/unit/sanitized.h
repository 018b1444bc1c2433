// SPDX-License-Identifier: Apache-2.0
// Under a sanitizer, which takes some ten times as long, statistics of many records say no more of memory,
// races and undefined behaviour than those of a few: the same code runs, fewer times. No bound differs, and
// the release build runs all of them.
#pragma once

namespace ifog::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

template <class Count>
constexpr Count fewer(Count all, Count sanitized) {
  return kSanitized ? sanitized : all;
}

}  // namespace ifog::test

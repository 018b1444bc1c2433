// SPDX-License-Identifier: Apache-2.0
// What a call that is refused says.
#pragma once

#include <exception>
#include <string>
#include <utility>

namespace ifog::test {

// The words of the exception that the call throws; `otherwise` where it throws none.
template <typename Call>
std::string refusal(Call&& call, std::string otherwise = "accepted") {
  try {
    std::forward<Call>(call)();
  } catch (const std::exception& error) {
    return error.what();
  }
  return otherwise;
}

}  // namespace ifog::test

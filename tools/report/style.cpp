// SPDX-License-Identifier: Apache-2.0
#include "tools/report/style.h"

#include <array>
#include <string_view>
#include <utility>

#include "report_source.h"

namespace ifog::report {
namespace {

// The page's colours of light mode, for programs without CSS variables.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kDaylight{{{"--paper", "#ffffff"},
                                                                                   {"--ink", "#1c2127"},
                                                                                   {"--muted", "#4a545e"},
                                                                                   {"--rule", "#8b949d"},
                                                                                   {"--grid", "#e1e5e9"},
                                                                                   {"--before", "#c26a1b"},
                                                                                   {"--after", "#1a5fb4"},
                                                                                   {"--fit", "#10151a"},
                                                                                   {"--second", "#3f7d4e"},
                                                                                   {"--raw", "#a3acb5"},
                                                                                   {"--third", "#7b4ba0"},
                                                                                   {"--fourth", "#b3263a"}}};

}  // namespace

std::string page_style() { return std::string(kReportStyle).append(kChartStyle); }

std::string page_script() { return kReportScript; }

std::string picture_style() {
  std::string rules = kChartStyle;
  for (const auto& [name, colour] : kDaylight) {
    const std::string use = "var(" + std::string(name) + ")";
    for (std::size_t at = rules.find(use); at != std::string::npos; at = rules.find(use, at))
      rules.replace(at, use.size(), colour);
  }
  return rules;
}

}  // namespace ifog::report

// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <stdexcept>

#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "filters/rules/rule.h"

namespace ifog {
namespace {

constexpr std::array kRules{
    RuleEntry{"ckf", make_ckf},   RuleEntry{"irwe-akfg", make_irwe_akfg},
    RuleEntry{"iae", make_iae},   RuleEntry{"rae", make_rae},
    RuleEntry{"mmae", make_mmae}, RuleEntry{"sage-husa", make_sage_husa},
    RuleEntry{"vb", make_vb},
};

}  // namespace

std::span<const RuleEntry> rules() { return kRules; }

std::vector<std::string_view> rule_names() {
  std::vector<std::string_view> names;
  names.reserve(kRules.size());
  for (const RuleEntry& entry : kRules) names.emplace_back(entry.name);
  return names;
}

std::unique_ptr<Rule> make_rule(const FilterSettings& settings) {
  for (const RuleEntry& entry : kRules)
    if (settings.rule == entry.name) return entry.make(settings);
  throw std::invalid_argument("rule: " + in_quotes(settings.rule) + ", expected " +
                              one_of(settings.rule, rule_names()));
}

}  // namespace ifog

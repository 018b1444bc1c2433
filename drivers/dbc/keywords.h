// SPDX-License-Identifier: Apache-2.0
// DBC keywords whose statements end with ';' and contain at most names that are needed.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace ifog::dbc {

// True for keywords that occur only at the start of a statement.
constexpr bool stands_first_only(std::string_view keyword) {
  constexpr std::array<std::string_view, 23> kKeywords{"CM_",
                                                       "BA_",
                                                       "BA_DEF_",
                                                       "BA_DEF_DEF_",
                                                       "BA_DEF_REL_",
                                                       "BA_REL_",
                                                       "BA_DEF_DEF_REL_",
                                                       "BA_DEF_SGTYPE_",
                                                       "BA_SGTYPE_",
                                                       "BA_DEF_SGTYPE_REL_",
                                                       "VAL_",
                                                       "VAL_TABLE_",
                                                       "SG_MUL_VAL_",
                                                       "SIG_GROUP_",
                                                       "SIG_VALTYPE_",
                                                       "SIG_TYPE_REF_",
                                                       "SIGTYPE_VALTYPE_",
                                                       "SGTYPE_",
                                                       "SGTYPE_VAL_",
                                                       "BO_TX_BU_",
                                                       "EV_DATA_",
                                                       "ENVVAR_DATA_",
                                                       "CAT_DEF_"};
  return std::find(kKeywords.begin(), kKeywords.end(), keyword) != kKeywords.end();
}

// True if the statement contains neither layout nor names of signals.
constexpr bool carries_no_layout(std::string_view keyword) {
  constexpr std::array<std::string_view, 7> kOthers{"EV_",        "CAT_",       "FILTER",  "BU_SG_REL_",
                                                    "BU_EV_REL_", "BU_BO_REL_", "NS_DESC_"};
  const bool read = keyword == "BA_" || keyword == "SG_MUL_VAL_" || keyword == "SIG_VALTYPE_";
  return (stands_first_only(keyword) && !read) ||
         std::find(kOthers.begin(), kOthers.end(), keyword) != kOthers.end();
}

}  // namespace ifog::dbc

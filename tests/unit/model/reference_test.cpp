// SPDX-License-Identifier: Apache-2.0
// The reference model and the table of forms, which the manual is made of: all that the program writes, reads
// and knows.
#include <regex>

#include "filters/model_file/form.h"
#include "filters/model_file/model.h"
#include "filters/settings/filter_table.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

std::string text_of(const std::string& file) {
  std::ifstream in(std::string(IFOG_SOURCE_DIR) + "/filters/" + file);
  EXPECT_TRUE(in) << file;
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// "[filter] window" for every key of the text, without figures by name.
std::set<std::string> keys_of(const std::string& text) {
  std::set<std::string> keys;
  std::string table, line;
  std::istringstream lines(text);
  const std::regex header(R"(^\[\[?([\w.]+)\]\]?.*)"), key(R"(^(\w+) = .*)");
  for (std::smatch found; std::getline(lines, line);)
    if (std::regex_match(line, found, header))
      table = found[1];
    else if (std::regex_match(line, found, key) && table != "source.before" && table != "source.after")
      keys.insert("[" + table + "] " + found[1].str());
  return keys;
}

// A model with everything in it that a file can hold.
Model everything() {
  Model model = parse_model(text_of("model_file/reference.toml"), "reference.toml");
  model.filter->state_parameters = {0.5};
  return model;
}

TEST(ModelReference, IsAModelAndHasEveryKeyThatIsWritten) {
  const std::set<std::string> shown = keys_of(text_of("model_file/reference.toml"));
  const std::set<std::string> written = keys_of(model_text(everything()));
  EXPECT_EQ(written, shown);
  EXPECT_GT(shown.size(), 40U);
}

TEST(ModelReference, ShowsTheDefaultsOfTheFilter) {
  const FilterSettings defaults;
  Model model = everything();
  model.filter->state_parameters.clear();
  for (const FilterSetting& setting : filter_table()) {
    const std::string key = setting.key;
    if (key == "process_noise" || key == "measurement_noise") continue;  // have none
    EXPECT_EQ(value_of(setting, *model.filter), value_of(setting, defaults)) << key;
  }
}

TEST(Forms, TheTableHasEachByItsName) {
  std::set<std::string> listed, known;
  const std::string text = text_of("effects/forms.md");
  const std::regex row(R"(\n\| `(\w+)` \|)");
  for (std::sregex_iterator found(text.begin(), text.end(), row), end; found != end; ++found)
    listed.insert((*found)[1]);
  for (const FormRules& rules : form_rules()) {
    known.emplace(rules.name);
    EXPECT_EQ(name_of(rules.form), rules.name);
  }
  EXPECT_EQ(listed, known);
  EXPECT_TRUE(known.contains("quantisation"));
}

// The page says the parameters' names, the program takes no others.
TEST(Forms, ThePageNamesTheParametersThatAFormNeeds) {
  const std::string text = text_of("effects/forms.md");
  for (const FormRules& rules : form_rules()) {
    const std::size_t at = text.find("| `" + std::string(rules.name) + "` |");
    ASSERT_NE(at, std::string::npos);
    const std::string row = text.substr(at, text.find('\n', at) - at);
    for (const ParameterRule& rule : rules.parameters) {
      const bool named = row.find("`" + std::string(rule.name) + "`") != std::string::npos;
      EXPECT_TRUE(named || !rule.needed || rule.name == "coefficient") << rules.name << rule.name;
    }
  }
}

}  // namespace
}  // namespace ifog

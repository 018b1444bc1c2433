// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>

#include "filters/effects/shape.h"
#include "filters/model_file/channel_names.h"
#include "filters/model_file/covariance.h"
#include "filters/model_file/form.h"
#include "filters/model_file/model.h"
#include "filters/model_file/model_axes.h"
#include "filters/model_file/sha256.h"
#include "filters/model_file/toml_text.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

Model full_model() {
  Model model;
  model.sensor = "left \"gyro\"";
  model.noise["x"] = {.N = 2.9e-7, .K = 1.25e-10};
  model.noise["z"] = {.Q = 0.1, .B = 1.0 / 3.0};
  FilterSettings filter;
  filter.rule = "vb";
  filter.state_parameters = {0.97, -0.2};
  filter.process_noise = 1e-17;
  filter.seed = 7;
  model.filter = filter;
  Effect linear;
  linear.form = "linear";
  linear.channel = "temperature_degC";
  linear.axis = "x";
  linear.reference = 25.0;
  linear.parameters = {{"coefficient", 1.23456789012345e-8, 2e-10, "rad/s/degC"}};
  Effect lookup;
  lookup.form = "lookup";
  lookup.channel = "ramp_counts";
  lookup.axis = "x";
  lookup.table_x = {0.0, 16384.0, 32768.0};
  lookup.table_y = {0.0, 3e-9, 1e-9};
  lookup.period = 32768.0;
  lookup.angle = true;
  lookup.parameters = {{"angle_rms", 1e-9, 1e-11, "rad"}};
  model.effects = {linear, lookup};
  model.covariance = {1.0, 0.5, 0.5, 2.0};
  model.ranges = {{"temperature_degC", -10.5, 41.0, 12.25}};
  model.source = {
      "a b.csv", "ff", "2026-01-01", {{"std_radps", 2.0}}, {{"std_radps", 1.0}, {"adev_10", 0.125}}};
  return model;
}

TEST(ModelFile, EverythingComesBackAsWritten) {
  const std::string text = model_text(full_model());
  const Model back = parse_model(text, "m.toml");
  EXPECT_EQ(model_text(back), text);
  EXPECT_EQ(back.effects[0].parameters[0].value, 1.23456789012345e-8);
  EXPECT_EQ(back.noise.at("z").B, 1.0 / 3.0);
  EXPECT_FALSE(back.noise.at("z").K.has_value());
  EXPECT_EQ(back.source.after.at("adev_10"), 0.125);
  EXPECT_EQ(back.identity(), sha256_hex(text).substr(0, 12));
  EXPECT_TRUE(back.effects[1].angle);
  const test::OwnFolder folder;
  folder.write("model.toml", text);
  EXPECT_EQ(model_text(read_model(folder.path("model.toml"))), text);
  EXPECT_THROW(read_model(folder.path("another.toml")), std::runtime_error);
}

// TOML's integers have 64 bits: what is larger is a number with a point.
TEST(ModelText, NumbersReadBackWhateverTheirSize) {
  EXPECT_EQ(toml_number(78447441097457238016.0), "78447441097457238016.0");
  EXPECT_EQ(toml_number(-3.0), "-3");
  EXPECT_EQ(toml_number(1e300), "1e+300");
}

TEST(ModelFile, ADifferenceOfChannelsIsTwoKeys) {
  Model model;
  Effect gradient;
  gradient.form = "linear";
  gradient.channel = difference_of("inner_degC", "outer_degC");
  gradient.parameters = {{"coefficient", 1e-6, 0.0, "rad/s/degC"}};
  model.effects = {gradient};
  model.ranges = {{gradient.channel, -2.0, 3.0}};
  const std::string text = model_text(model);
  EXPECT_TRUE(test::has(text, "channel = \"inner_degC\"\nminus_channel = \"outer_degC\"\n"));
  const Model back = parse_model(text, "m.toml");
  EXPECT_EQ(back.effects[0].channel, gradient.channel);
  EXPECT_EQ(back.ranges[0].channel, gradient.channel);
  EXPECT_THROW(parse_model("version = 1\n[[effect]]\nform = \"linear\"\nminus_channel = \"b_V\"\n", "m.toml"),
               std::runtime_error);
}

std::string complaint(const std::string& text) {
  return test::refusal([&] { parse_model(text, "m.toml"); });
}

TEST(ModelFile, BadInputIsNamedByLineAndKey) {
  const std::string head = "version = 1\n", effect = head + "[[effect]]\nform = ";
  for (const auto& [text, place] : std::initializer_list<std::pair<std::string, const char*>>{
           {"sensor = \"a\"\n", "1: version: expected version = 1"},
           {"version = 2\n", "1: version = 2: expected version = 1"},
           {"version = \n", "1: "},
           {head + "colour = 3\n", "2: colour = 3: unknown key"},
           {effect + "\"linear\"\nchanel = \"t\"\n",
            "4: effect[1].chanel = 't': unknown key, did you mean 'channel'?"},
           {effect + "\"lookup\"\ntable_x = [1.0, 0.0]\ntable_y = [0.0, 0.0]\n", "4: effect[1].table_x"},
           {head + "[[noise]]\nN = -1.0\n", "3: noise[1].N = -1.0: expected at least 0"},
           {head + "[[noise]]\naxis = \"x\"\nN = 1\n[[noise]]\naxis = \"x\"\nN = 2\n",
            "6: noise[2].axis = 'x': expected one table [[noise]] for each axis, this is its second"},
           {head + "covariance = [1.0]\n", "1: covariance: expected 0 numbers"}})
    EXPECT_TRUE(complaint(text).starts_with(std::string("m.toml:") + place)) << text << complaint(text);
}

// The parser quotes the character it stumbles over, and a key may hold any.
TEST(ModelFile, AComplaintIsOneLineWhateverTheFileHolds) {
  EXPECT_EQ(complaint("version = 1\nsen\n"),
            "m.toml:2: Error while parsing key-value pair: expected '=', saw '\\n'");
  EXPECT_EQ(complaint("version = 1\n\"a\\nb\\u0001\" = 3\n"), "m.toml:2: a\\nb\\x01 = 3: unknown key");
}

// The parser is recursive in them. No kind of string hides one.
TEST(ModelFile, AKeyOfVeryManyPartsIsRefused) {
  std::string key = "a";
  for (int i = 0; i < 200'000; ++i) key += ".a";
  for (const std::string before : {"", "e = {d = \"\"\"x\"\"\"\"\", ", "'"})
    EXPECT_EQ(complaint("d = \"\"\"x \" y\"\"\"\n" + before + key + " = 1\n"),
              "m.toml:2: more than 5000 dots in a line, expected fewer");
}

// FIPS 180-4 example values, and the million-a test.
TEST(Sha256, MatchesThePublishedValues) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_hex(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

std::string with(const std::string& line, const std::string& instead) {
  std::string text = model_text(full_model());
  const std::size_t at = text.find(line);
  EXPECT_NE(at, std::string::npos) << line;
  return text.replace(at, line.size(), instead);
}

TEST(ModelFile, NumbersThatNoSensorHasAreRefusedByLine) {
  ASSERT_EQ(complaint(model_text(full_model())), "accepted");
  for (const auto& [line, instead] : std::initializer_list<std::pair<const char*, const char*>>{
           {"reference = 25", "reference = nan"},
           {"reference = 25", "reference = inf"},
           {"value = 1.23456789012345e-08", "value = 1e308"},
           {"value = 1.23456789012345e-08", "value = nan"},
           {"std_error = 2e-10", "std_error = -1.0"},
           {"std_error = 2e-10", "std_error = inf"},
           {"period = 32768", "period = -1.0"},
           {"period = 32768", "period = inf"},
           {"low = -10.5", "low = -inf"},
           {"low = -10.5", "low = 50.0"},
           {"high = 41", "high = nan"},
           {"early_s = 12.25", "early_s = -1"},
           {"early_s = 12.25", "early_s = 61"},
           {"N = 2.9e-07", "N = nan"},
           {"process_noise = 1e-17", "process_noise = inf"},
           {"table_y = [0, 3e-09", "table_y = [0, 1e300"}}) {
    const std::string text = with(line, instead);
    const std::string said = complaint(text);
    // The line that was changed; of a range turned round, the line that shows it.
    const std::string changed = instead == std::string("low = 50.0") ? "high = 41" : instead;
    const auto number =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(changed)), '\n') + 1;
    EXPECT_EQ(said.find("m.toml:" + std::to_string(number) + ": "), 0U) << instead << ": " << said;
    EXPECT_TRUE(test::has(said, "expected"));
  }
}

TEST(ModelFile, ACovarianceMustBeOne) {
  for (const auto& [values, flaw] : std::initializer_list<std::pair<const char*, const char*>>{
           {"[1.0, 0.5, 0.4, 2.0]", "differs"},
           {"[-1.0, 0.0, 0.0, 2.0]", "negative variance in row 1"},
           {"[1.0, 1.5, 1.5, 2.0]", "more than the variances allow"},
           {"[0.0, 1.0, 1.0, 2.0]", "more than the variances allow"},
           {"[1.0, nan, nan, 2.0]", "finite"},
           {"[1.0, 0.5, 0.5, inf]", "finite"}}) {
    const std::string said =
        complaint(with("covariance = [1, 0.5, 0.5, 2]", std::string("covariance = ") + values));
    EXPECT_TRUE(test::has(said, flaw)) << values << ": " << said;
  }
}

// A reported line is not corrected, and its three parameters make most of a matrix of them all.
TEST(ModelFile, HasTheCovarianceOfWhatIsCorrected) {
  Model model;
  Effect bias, line;
  bias.form = "bias";
  bias.parameters = {{"coefficient", 1e-6, 2e-8, "rad/s"}};
  line.form = "line";
  line.parameters = {
      {"cosine", 1e-6, 3e-8, "rad/s"}, {"sine", 0.0, 3e-8, "rad/s"}, {"frequency_hz", 5.0, 1e-3, "Hz"}};
  model.effects = {line, bias};
  const std::vector<double> variances = {9e-16, 9e-16, 1e-6, 4e-16};
  model.covariance.assign(16, 0.0);
  for (std::size_t i = 0; i < 4; ++i) model.covariance[5 * i] = variances[i];
  const std::string text = model_text(model);
  EXPECT_TRUE(test::has(text, "covariance = [4e-16]"));
  const std::string all =
      "covariance = [9e-16, 0, 0, 0, 0, 9e-16, 0, 0, 0, 0, 1e-6, 0, 0, 0, 0, 4e-16]";  // as files had it
  std::string before = text;
  before.replace(before.find("covariance = [4e-16]"), 20, all);
  for (const std::string& each : {text, before}) {
    const Model read = parse_model(each, "m.toml");
    ASSERT_EQ(read.covariance.size(), 16U);
    for (std::size_t i = 0; i < 16; ++i) EXPECT_NEAR(read.covariance[i], model.covariance[i], 1e-22) << i;
  }
  model.effects = {line};
  model.covariance.resize(9);
  EXPECT_FALSE(test::has(model_text(model), "covariance"));
}

// What a form does not know would correct nothing, in silence.
TEST(ModelFile, TheParametersAreThoseOfTheForm) {
  const std::string linear = "form = \"linear\"\n", lagged = "form = \"lagged\"\n";
  // A product has its second form's as well, and the lag of no other.
  const std::string product = "form = \"product\"\nwith_channel = \"u_V\"\nwith_form = ";
  const std::string coefficient = "coefficient\"\nvalue = 1", lag = "lag_s\"\nvalue = 3";
  struct Case {
    std::string keys;
    std::vector<std::string> parameters;
    const char* said;  // how it begins, behind the file's name
  };
  for (const Case& each : std::initializer_list<Case>{
           {linear, {"coeficient\"\nvalue = 1"}, ":6: effect[1].parameter[1].name = 'coeficient': "},
           {linear, {}, ":2: effect[1].parameter: form linear needs "},
           {linear, {coefficient, coefficient}, ":9: effect[1].parameter[2].name = 'coefficient': "},
           {linear, {coefficient, lag}, ":9: effect[1].parameter[2].name = 'lag_s': "},
           {lagged, {coefficient}, ":2: effect[1].parameter: form lagged needs "},
           {lagged, {coefficient, "lag_s\"\nvalue = 0"}, ":10: effect[1].parameter[2].value = 0: "},
           {lagged, {coefficient, lag}, "accepted"},
           {"form = \"lineer\"\n", {}, ":3: effect[1].form = 'lineer': unknown form, did you mean 'linear'?"},
           {product + "\"lagged\"\n", {coefficient, lag}, "accepted"},
           {product + "\"linear\"\n", {coefficient, lag}, ":"},
           {product + "\"lagged\"\n", {coefficient}, ":"},
           {"form = \"outliers\"\n", {"of_any_name\"\nvalue = 1"}, "accepted"}}) {
    std::string text = "version = 1\n[[effect]]\n" + each.keys + "channel = \"t_degC\"\n";
    for (const std::string& parameter : each.parameters)
      text += "[[effect.parameter]]\nname = \"" + parameter + "\n";
    const std::string said = complaint(text);
    EXPECT_TRUE(said.starts_with(each.said) || said.starts_with(std::string("m.toml") + each.said))
        << text << said;
  }
}

// What the daemon would refuse at its start, without a line.
TEST(ModelFile, WhatAnEffectTakesItsValueFromIsRefusedByLine) {
  const std::string head = "version = 1\n", effect = head + "[[effect]]\n";
  const std::string product = effect + "form = \"product\"\nchannel = \"t_degC\"\nwith_channel = \"u_V\"\n";
  const std::string value = "[[effect.parameter]]\nname = \"coefficient\"\nvalue = 1\n";
  for (const auto& [text, place] : std::initializer_list<std::pair<std::string, const char*>>{
           {product + "with_form = \"quadratc\"\n" + value, "6: effect[1].with_form = 'quadratc': "},
           {product + "with_form = \"lookup\"\n" + value, "6: effect[1].with_form = 'lookup': "},
           {product + "with_form = \"product\"\n" + value, "6: effect[1].with_form = 'product': "},
           {product + "with_form = \"line\"\n" + value, "6: effect[1].with_form = 'line': "},
           {product + "with_form = \"outliers\"\n" + value, "6: effect[1].with_form = 'outliers': "},
           {product + value, "2: effect[1].with_form: no form"},
           {effect + "form = \"product\"\nchannel = \"t_degC\"\nwith_form = \"linear\"\n" + value,
            "2: effect[1].with_channel: a product is of two channels"},
           {effect + "form = \"linear\"\n" + value, "2: effect[1].channel: form linear is of a channel"},
           {effect + "form = \"cosine\"\nchannel = \"heading_deg\"\n" + value,
            "2: effect[1].period: form cosine needs"},
           {effect + "form = \"lookup\"\nchannel = \"t\"\ntable_x = [1.0]\ntable_y = [1.0]\n",
            "5: effect[1].table_x: "},
           {head + "[filter]\nstate = \"random-wlk\"\n",
            "3: filter.state = 'random-wlk': expected one of random-walk, "},
           {head + "[filter]\nrule = \"ckff\"\n", "3: filter.rule = 'ckff': expected one of ckf, "}})
    EXPECT_TRUE(complaint(text).starts_with(std::string("m.toml:") + place)) << text << complaint(text);
  EXPECT_EQ(complaint(head + "[filter]\nstate = \"arma(2,1) + harmonic\"\n"), "accepted");
}

TEST(ModelAxes, WhatIsOfNoAxisHereIsTold) {
  Model model;
  model.effects.resize(2);
  model.effects[1].axis = "y";
  model.noise["q"] = {};
  const std::vector<std::string> one = {""}, three = {"x", "y", "z"};
  EXPECT_EQ(
      remarks_on_axes(model, three),
      (std::vector<std::string>{"1 of its effects belong to a sensor with one axis and are subtracted from "
                                "each of x, y, z; expected effects with an axis",
                                "has the noise of an axis 'q', of which there is none here, but x, y, z"}));
  EXPECT_EQ(remarks_on_axes(model, one),
            (std::vector<std::string>{"has the noise of an axis 'q', of which there is none here"}));
  model.noise = {{"x", {}}};
  model.effects[0].axis = "x";
  EXPECT_TRUE(remarks_on_axes(model, three).empty());
}

TEST(ModelFile, CorrelationsThatContradictEachOtherAreNoCovariance) {
  // Each pair may be so correlated, the three together not: the determinant is 1 - 3 * 0.81 - 2 * 0.729 < 0.
  std::string flaw = covariance_flaw({1.0, 0.9, 0.9, 0.9, 1.0, -0.9, 0.9, -0.9, 1.0}, 3);
  EXPECT_EQ(flaw, "a combination of parameters has a negative variance");
  EXPECT_EQ(covariance_flaw({1e-18, 0.9e-9, 0.0, 0.9e-9, 1.0, 0.0, 0.0, 0.0, 0.0}, 3), "");
  EXPECT_EQ(covariance_flaw({1.0, 1.0, 1.0, 1.0}, 2), "");  // one parameter twice, exactly
}

TEST(ModelFile, WhatIsNoRegularFileIsRefusedAndNotWaitedFor) {
  const test::OwnFolder folder;
  const std::string fifo = folder.path("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  for (const std::string& path : {fifo, std::string("/dev/zero"), folder.folder()}) {
    EXPECT_EQ(test::refusal([&] { read_model(path); }), path + ": is no regular file");
  }
  folder.write("large", std::string((16U << 20U) + 1, '#'));
  EXPECT_THROW(read_model(folder.path("large")), std::runtime_error);
}

// Each axis' square over the mean of all; nothing where one axis has none.
TEST(ModelFile, SaysWhatEachAxisNoiseIsOfTheMean) {
  Model model;
  model.noise["x"] = {.N = 1e-6, .K = 3e-9};
  model.noise["y"] = {.N = 2e-6, .K = 1e-9};
  const std::vector<std::string> both{"x", "y"}, one{"x"}, more{"x", "z"};
  const AxisShares shares = noise_of_axes(model, both, 100.0, 0.0).shares;
  ASSERT_TRUE(shares.noise && shares.walk);
  EXPECT_NEAR((*shares.noise)[0], 0.4, 1e-12);
  EXPECT_NEAR((*shares.noise)[1], 1.6, 1e-12);
  EXPECT_NEAR((*shares.walk)[0], 1.8, 1e-12);
  EXPECT_EQ((*noise_of_axes(model, one, 100.0, 0.0).shares.noise)[0], 1.0);
  EXPECT_FALSE(noise_of_axes(model, more, 100.0, 0.0).shares.noise);
  model.noise["y"].K.reset();
  EXPECT_TRUE(noise_of_axes(model, both, 100.0, 0.0).shares.noise);
  EXPECT_FALSE(noise_of_axes(model, both, 100.0, 0.0).shares.walk);
  // A ring laser's dither is in a tuned filter's noise, here 2e-8, and not in N: which axis has how much nobody knows.
  EXPECT_NEAR(*noise_of_axes(model, both, 1000.0, 0.0).sample, 2.5e-9, 1e-18);
  EXPECT_NEAR((*noise_of_axes(model, both, 1000.0, 2e-8).shares.noise)[0], 1.85e-8 / 2e-8, 1e-9);
}

}  // namespace
}  // namespace ifog

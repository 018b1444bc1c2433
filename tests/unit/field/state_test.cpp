// SPDX-License-Identifier: Apache-2.0
// The state folder: proposals, the history of what was adopted, and the mark of a running daemon.
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon/config/config.h"
#include "daemon/state/running_mark.h"
#include "daemon/state/state_folder.h"
#include "drivers/flight/archive.h"
#include "drivers/flight/folder.h"
#include "drivers/transport/clock.h"
#include "tests/unit/test.h"
#include "tools/ifog/field/field.h"
#include "tools/ifog/field/models.h"
#include "tools/ifog/field/recorded.h"

namespace ifog::tools {
namespace {

namespace fs = std::filesystem;

class StateFolder : public testing::Test, protected test::OwnFolder {
 protected:
  template <typename Call>
  static std::string complaint(Call&& call) {
    return test::refusal([&] { call(); }, "");
  }
};

Model model_with(double coefficient) {
  Model out;
  out.sensor = "nose";
  Effect effect;
  effect.form = "linear";
  effect.channel = "temperature_degC";
  effect.reference = 25.0;
  effect.parameters = {{"coefficient", coefficient, 1e-9, "rad/s/degC"}};
  out.effects = {effect};
  return out;
}

Proposal proposal_of(const Model& model, const ModelName& against) {
  Proposal out;
  out.sensor = "nose";
  out.made = "2026-01-31T02:30:00Z";
  out.why = "linear in temperature_degC";
  out.against = against;
  out.model = name_of(model);
  out.model_file = "nose.proposal-" + out.model.identity + ".toml";
  out.report_file = "nose.proposal-" + out.model.identity + ".html";
  AxisGain gain;
  gain.kept.seconds = 3600.0;
  gain.kept.share = 0.98;
  gain.kept.share_error = 0.02;
  gain.kept.errors = {{10.0, 360, 4e-8, 1e-8}};
  out.gain = {gain};
  return out;
}

TEST_F(StateFolder, AProposalComesBackAsItWasWritten) {
  const Model model = model_with(4e-8);
  write_proposal(folder(), proposal_of(model, {"abc", "abcdef"}), model, "<html>");
  const std::optional<Proposal> back = read_proposal(folder(), "nose");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->against, (ModelName{"abc", "abcdef"}));
  EXPECT_EQ(back->model, name_of(model));
  EXPECT_EQ(back->why, "linear in temperature_degC");
  ASSERT_EQ(back->gain.size(), 1U);
  EXPECT_EQ(back->gain[0].kept.share, 0.98);
  EXPECT_EQ(back->gain[0].kept.errors[0].after_radps, 1e-8);
  EXPECT_EQ(name_of(proposed_model(folder(), *back)), name_of(model));
  EXPECT_EQ(content(back->report_file), "<html>");
  EXPECT_EQ(sensors_with_proposal(folder()), std::vector<std::string>{"nose"});
  EXPECT_FALSE(read_proposal(folder(), "tail"));
}

// What `ifog proposals` and `status` print to be copied is about the field that they were asked about.
TEST_F(StateFolder, ACommandToBeCopiedLooksAfterTheSameField) {
  FieldOptions options;
  options.state = path("its state");
  EXPECT_EQ(Field(options).command("adopt", "nose"), "ifog adopt nose --state '" + path("its state") + "'");
  options = {};
  options.config = path("a b.toml");
  write("a b.toml",
        "[[sensor]]\nname = \"nose\"\ndriver = \"kvh1750\"\n[sensor.transport]\ntype = \"serial\"\ndevice = "
        "\"/dev/ttyS0\"\n");
  EXPECT_EQ(Field(options).command("revert", "nose"), "ifog revert nose --config '" + path("a b.toml") + "'");
}

TEST_F(StateFolder, ANewProposalTakesTheOldOnesPlaceAndRemovalLeavesNothing) {
  const Model first = model_with(4e-8), second = model_with(5e-8);
  write_proposal(folder(), proposal_of(first, {}), first, "1");
  write_proposal(folder(), proposal_of(second, {}), second, "2");
  EXPECT_EQ(files(), 3U);
  EXPECT_EQ(read_proposal(folder(), "nose")->model, name_of(second));
  remove_proposal(folder(), "nose");
  EXPECT_EQ(files(), 0U);
}

TEST_F(StateFolder, BookmarksComeBack) {
  EXPECT_FALSE(read_bookmark(folder(), "nose"));
  write_bookmark(folder(), {"nose", 17, "2026-01-31T02:30:00Z", "nothing found"});
  EXPECT_EQ(read_bookmark(folder(), "nose")->until, 17U);
  EXPECT_EQ(read_bookmark(folder(), "nose")->said, "nothing found");
}

// A night whose disk is full, at whichever of the three files: the proposal that waited stands, and nothing
// of the new one is left.
TEST_F(StateFolder, AProposalThatCouldNotBeWrittenLeavesNothing) {
  const Model first = model_with(4e-8), second = model_with(5e-8);
  const Proposal wanted = proposal_of(second, {});
  for (const std::string& refuses : {wanted.report_file, std::string("nose.proposal.json")}) {
    fs::create_directory(fs::path(folder()) / refuses);
    EXPECT_THROW(write_proposal(folder(), wanted, second, "2"), std::runtime_error);
    fs::remove(fs::path(folder()) / refuses);
    EXPECT_EQ(files(), 0U) << refuses;
  }
  write_proposal(folder(), proposal_of(first, {}), first, "1");
  fs::create_directory(fs::path(folder()) / wanted.report_file);
  EXPECT_THROW(write_proposal(folder(), wanted, second, "2"), std::runtime_error);
  fs::remove(fs::path(folder()) / wanted.report_file);
  EXPECT_EQ(files(), 3U);
  EXPECT_EQ(read_proposal(folder(), "nose")->model, name_of(first));
}

TEST_F(StateFolder, ADamagedProposalIsOneLine) {
  const Model model = model_with(4e-8);
  write_proposal(folder(), proposal_of(model, {}), model, "");
  const std::string whole = content("nose.proposal.json");
  for (const std::size_t length : {std::size_t{0}, whole.size() / 2, whole.size() - 3}) {
    write("nose.proposal.json", whole.substr(0, length));
    EXPECT_EQ(complaint([&] { (void)read_proposal(folder(), "nose"); }),
              path("nose.proposal.json") + ": is no JSON object, expected schema ifog.proposal/1");
  }
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = whole;
    changed.replace(changed.find(from), from.size(), to);
    write("nose.proposal.json", changed);
    const std::string said = complaint([&] { (void)read_proposal(folder(), "nose"); });
    EXPECT_FALSE(ifog::test::has(said, "\n"));
    return said;
  };
  EXPECT_TRUE(ifog::test::has(with("ifog.proposal/1", "ifog.proposal/2"), "expected ifog.proposal/1"));
  EXPECT_TRUE(ifog::test::has(with("\"why\"", "\"who\""), "damaged"));
  EXPECT_TRUE(ifog::test::has(with("\"nose\"", "\"tail\""), "another sensor"));
  // What the index names is removed and read: nothing but what lies beside it.
  EXPECT_TRUE(ifog::test::has(with("nose.proposal-", "../../proposal-"), "outside of its folder"));
  const Proposal proposal = proposal_of(model, {});
  write(proposal.model_file, model_text(model_with(9e-8)));
  EXPECT_TRUE(
      ifog::test::has(complaint([&] { (void)proposed_model(folder(), proposal); }), "is another model"));
}

TEST_F(StateFolder, TheHistoryKeepsEveryModelAndRevertsCloseLikeBrackets) {
  const Model a = model_with(1e-8), b = model_with(2e-8);
  const auto change = [](const char* what, const ModelName& model, const ModelName& replaced) {
    return ModelChange{what, "2026-01-31T08:00:00Z", model, replaced, "why", {}, ""};
  };
  {
    History history(folder(), "nose");
    EXPECT_EQ(history.in_force(), nullptr);
    history.add(change("adopt", name_of(a), {}), std::nullopt);
    history.add(change("adopt", name_of(b), name_of(a)), a);
    history.set_outcome("the promise came true");
  }
  History history(folder(), "nose");
  ASSERT_EQ(history.changes().size(), 2U);
  EXPECT_EQ(history.changes().back().outcome, "the promise came true");
  ASSERT_NE(history.in_force(), nullptr);
  EXPECT_EQ(history.in_force()->model, name_of(b));
  EXPECT_EQ(name_of(*history.kept(name_of(a))), name_of(a));
  EXPECT_FALSE(history.kept({}));
  history.add(change("revert", name_of(a), name_of(b)), b);
  ASSERT_NE(history.in_force(), nullptr);
  EXPECT_EQ(history.in_force()->model, name_of(a));
  history.add(change("revert", {}, name_of(a)), a);
  EXPECT_EQ(history.in_force(), nullptr);
  history.take_back();
  EXPECT_EQ(history.in_force()->model, name_of(a));
  EXPECT_EQ(History(folder(), "nose").changes().size(), 3U);
}

TEST_F(StateFolder, OneCommandAtATime) {
  const StateLock mine(folder());
  EXPECT_TRUE(
      ifog::test::has(complaint([&] { const StateLock other(folder()); }), "another command works in it"));
  EXPECT_TRUE(ifog::test::has(complaint([&] { const StateLock other(path("none")); }),
                              "expected the daemon's state folder"));
}

TEST_F(StateFolder, TheMarkIsThereAsLongAsItsProcess) {
  EXPECT_FALSE(running_daemon(folder()));
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    static RunningMark mark;
    (void)!::write(ready[1], mark.set(folder()).empty() ? "y" : "n", 1);
    pause();
    _exit(0);
  }
  char said = 0;
  ASSERT_EQ(::read(ready[0], &said, 1), 1);
  EXPECT_EQ(said, 'y');
  EXPECT_EQ(running_daemon(folder()), child);
  RunningMark second;
  EXPECT_TRUE(ifog::test::has(second.set(folder()), "process " + std::to_string(child)));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(running_daemon(folder()));
  close(ready[0]);
  close(ready[1]);
}

// A signal goes to the process that is found: a lock that nobody holds by a number, or holds for reading
// only, is not the daemon's; and what is no plain file is not opened to wait for somebody.
TEST_F(StateFolder, AMarkThatIsNoDaemonsIsNotTakenForOne) {
  write("ifogd.lock", "");
  const int fd = ::open(path("ifogd.lock").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(fd, 0);
  for (const short type : {short{F_RDLCK}, short{F_WRLCK}}) {
    struct flock lock {};
    lock.l_type = type;
    lock.l_whence = SEEK_SET;
    ASSERT_EQ(::fcntl(fd, F_OFD_SETLK, &lock), 0);
    EXPECT_TRUE(ifog::test::has(complaint([&] { (void)running_daemon(folder()); }),
                                "by no process that can be seen"));
    RunningMark mark;
    EXPECT_NE(mark.set(folder()), "");
    EXPECT_FALSE(mark.is_set());
  }
  ::close(fd);
  fs::remove(path("ifogd.lock"));
  ASSERT_EQ(mkfifo(path("ifogd.lock").c_str(), 0644), 0);
  EXPECT_NE(complaint([&] { (void)running_daemon(folder()); }), "");
  fs::remove(path("ifogd.lock"));
  write("private", "mine");
  fs::permissions(path("private"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("private", path("ifogd.lock"));
  RunningMark mark;
  EXPECT_NE(mark.set(folder()), "");
  EXPECT_EQ(fs::status(path("private")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

// Who may write into the folder must not make root write elsewhere.
TEST_F(StateFolder, NothingIsWrittenThroughALink) {
  write("elsewhere", "mine");
  fs::create_symlink("elsewhere", path("nose.night.json"));
  EXPECT_TRUE(ifog::test::has(complaint([&] {
                                write_bookmark(folder(), {"nose", 1, "now", "said"});
                              }),
                              "no regular file"));
  EXPECT_EQ(content("elsewhere"), "mine");
}

// Killed between the history and the model: the model before is in use, so the change never was.
TEST_F(StateFolder, AChangeThatNeverCameAboutIsForgotten) {
  const Model first = model_with(1e-8), second = model_with(2e-8);
  History history(folder(), "nose");
  history.add({"adopt", "a", name_of(first), {}, "", {}, ""}, std::nullopt);
  history.add({"adopt", "b", name_of(second), name_of(first), "", {}, ""}, first);
  history.drop_incomplete_change(name_of(second));
  EXPECT_EQ(history.changes().size(), 2U);
  history.drop_incomplete_change(name_of(first));
  ASSERT_EQ(history.changes().size(), 1U);
  EXPECT_EQ(history.in_force()->model, name_of(first));
}

TEST_F(StateFolder, ASensorWithoutAModelHasTheAdoptedOne) {
  const std::string sensors =
      "[[sensor]]\nname = \"nose\"\ndriver = \"kvh1750\"\n[sensor.transport]\ntype = \"file\"\npath = \"a\"\n"
      "[[sensor]]\nname = \"tail\"\nmodel = \"own.toml\"\ndriver = \"kvh1750\"\n[sensor.transport]\ntype = "
      "\"file\"\npath = \"a\"\n";
  write("ifogd.toml", "[daemon]\nstate_folder = \"" + folder() + "\"\n" + sensors);
  EXPECT_EQ(read_config(path("ifogd.toml")).sensors[0].model, "");
  write("nose.model.toml", model_text(model_with(4e-8)));
  write("tail.model.toml", model_text(model_with(4e-8)));
  const Config config = read_config(path("ifogd.toml"));
  EXPECT_EQ(config.sensors[0].model, path("nose.model.toml"));
  EXPECT_EQ(config.sensors[1].model, path("own.toml"));
  // As a flight recording has it.
  const Config alone = parse_config(config.sensors[0].text, path("ifogd.toml"));
  EXPECT_EQ(alone.sensors[0].model, path("nose.model.toml"));
}

// A warm-up counts from power-up: recordings of several power-ups are not one.

class PoweredRecordings : public testing::Test, protected test::OwnFolder {
 protected:
  PoweredRecordings() {
    sensor_.name = "nose";
    sensor_.record.folder = folder();
  }
  // A closed file of so many bytes, of a sensor that was switched on then.
  void record(std::optional<std::int64_t> powered_ns, std::size_t bytes, const std::string& boot = "") {
    FlightHeader header;
    header.sensor = "nose";
    header.driver = "kvh1750";
    header.powered_ns = powered_ns;
    header.boot = boot;
    FlightArchive archive(make_flight_folder(path("nose")), {}, header);
    std::vector<std::uint8_t> payload(bytes);
    // That no compression makes smaller.
    for (std::uint32_t i = 0; i < bytes; ++i)
      payload[i] = static_cast<std::uint8_t>((i * 2654435761U) >> 13U ^ i * i);
    archive.add({FlightKind::bytes, 0, 0, 0, 1}, payload);
    archive.close(1, realtime_ns());
  }
  [[nodiscard]] std::vector<std::uint64_t> judged() const {
    std::vector<std::uint64_t> out;
    for (const RecordedFile& file : of_one_power_up(recorded_files(sensor_))) out.push_back(file.number);
    return out;
  }
  SensorConfig sensor_;
};

TEST_F(PoweredRecordings, OfSeveralPowerUpsTheLongestIsJudged) {
  constexpr std::int64_t kDay = 86'400'000'000'000;
  record(5 * kDay, 3000);
  record(6 * kDay, 2000);
  record(6 * kDay + 1'000'000'000,
         2500);  // another run of the daemon: its clock is off by what the wall clock was set
  record(7 * kDay, 1000);
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{2, 3}));
  record(7 * kDay, 9000);
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{4, 5}));
}

TEST_F(PoweredRecordings, AComputerWithoutAClockBeginsEveryDayAtTheSameTime) {
  constexpr std::int64_t kDay = 86'400'000'000'000;
  record(kDay, 2500, "one");
  record(kDay, 2000, "other");
  record(kDay + 1'000'000'000, 2000, "other");
  record(kDay, 3000, "third");
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{2, 3}));
}

TEST_F(PoweredRecordings, AllAreWhereNobodySaysWhenItWas) {
  record(std::nullopt, 100);
  record(std::nullopt, 2000);
  record(std::nullopt, 100);
  EXPECT_EQ(judged(), (std::vector<std::uint64_t>{1, 2, 3}));
}

}  // namespace
}  // namespace ifog::tools

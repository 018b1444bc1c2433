#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Texts for people and their use: file names of another format than the output, commands printed to be copied, files without the
requested content, and counts.

usage: words.py PATH_OF_IFOG SOURCE_DIR
"""
import gzip
import html
import json
import math
import os
import random
import re
import subprocess
import sys

from run import IFOG, SOURCE, columns, ifog, main_of, ran, refused

ROWS, RATE_HZ, SIGMA = 3000, 100, 1e-5
READERS = ("allan", "tune", "compare", "diagnose")


class Checks:
    def __init__(self, folder):
        self.folder = folder
        self.random = random.Random(11)
        self.noise = [self.random.gauss(0, SIGMA) for _ in range(ROWS)]
        self.one = self.write("one.csv")

    def write(self, name, header="time_s,rate_radps", separator=","):
        path = self.folder / name
        rows = [f"{i / RATE_HZ!r}{separator}{rate!r}" for i, rate in enumerate(self.noise)]
        path.write_text("\n".join(([header] if header else []) + rows) + "\n")
        return path

    def check_what_stays_is_named_once(self):
        """A line that grows leaves a peak at its own place, which is not another thing. Lines are said not to be corrected."""
        path, growing = self.folder / "growing.csv", [v + SIGMA * (0.4 + 2 * i / ROWS) * math.sin(2 * math.pi * 7.3137 * i / RATE_HZ) for i, v in enumerate(self.noise)]
        path.write_text("\n".join(["time_s,rate_radps", *[f"{i / RATE_HZ!r},{v!r}" for i, v in enumerate(growing)]]) + "\n")
        said = ifog("diagnose", path)
        assert said.count("1. line") == 1 and "line, not corrected: " in said, said
        assert "what is left of the line at 7.314 Hz" in said and "that is no line" not in said, said
        assert "Nothing more is found in the rest." in ifog("diagnose", self.one, "--report", self.folder / "one.html")
        page = (self.folder / "one.html").read_text()
        assert "Nothing more is found in what remains." in page and "own noise" not in page

    def check_a_name_says_what_is_written(self):
        """For a format that is not written, or not by this command, no file is created."""
        folder = self.folder / "endings"
        folder.mkdir()
        scenario, kvh = SOURCE / "tools/simulate/scenarios/rest.toml", ["--driver", "kvh1750"]
        for ending in (".mat", ".npz", ".ifr", ".lcm"):
            to = folder / ("out" + ending)
            commands = [["denoise", self.one, "--output", to], ["convert", self.one, to], ["simulate", scenario, "--output", to]]
            # A device's bytes may have any name that does not belong to another format.
            if ending in (".ifr", ".lcm"):
                commands += [[*command, *kvh] for command in commands[1:]]
            for command in commands:
                refused(2, *command, says=[f"'{to}', expected a name ending in .csv, .csv.gz or .h5"])
        for ending in (".kvh", ".log", ".txt"):
            refused(2, "denoise", self.one, "--output", folder / ("out" + ending), says=["expected a name ending in .csv, .csv.gz or .h5\n"])
        refused(2, "simulate", scenario, "--output", folder / "out.csv", "--truth", folder / "truth.mat", says=["--truth", ".json, .csv"])
        assert not list(folder.iterdir()), list(folder.iterdir())
        begins = {"csv": b"time_s,", "gz": b"\x1f\x8b", "h5": b"\x89HDF"}
        for name in ("out.csv", "out.csv.gz", "out.h5", "out", "UP.CSV", "Up.Csv.Gz", "UP.H5"):
            ifog("denoise", self.one, "--output", folder / name)
            assert (folder / name).read_bytes().startswith(begins[name.lower().rsplit(".", 1)[-1] if "." in name else "csv"]), name
            ifog("allan", folder / name)
        ifog("allan", self.one, "--plot", folder / "UP.PNG")
        assert (folder / "UP.PNG").read_bytes().startswith(b"\x89PNG")

    def check_a_path_is_whole(self):
        """A folder's name of 120 bytes: what was written can be copied, and what is refused found."""
        folder = self.folder / ("recordings_of_the_left_wing_" * 4 + "gyro_two")
        folder.mkdir()
        assert f"wrote {folder / 'out.csv'}\n" in ran("convert", self.one, folder / "out.csv").stdout
        refused(2, "convert", self.one, folder / "out.npz", says=[f"'{folder / 'out.npz'}', expected"])

    def check_a_format_that_is_not_chosen_by_the_name_refuses_anothers(self):
        """A page in report.pdf, JSON in figures.csv, candump's lines in a CSV."""
        folder = self.folder / "kinds"
        folder.mkdir()
        for option, good, others, command in (
                ("--report", ".html", (".pdf", ".md", ".json", ".PDF"), ["diagnose", "--quiet", self.one]),
                ("--json", ".json", (".csv", ".html", ".txt", ".h5", ".toml", ".Csv"), ["allan", self.one]),
                ("--json", ".json", (".csv", ".toml"), ["tune", self.one, "--state", "random-walk"]),
                ("--json", ".json", (".csv", ".png"), ["drivers"]),
                ("--write-model", ".toml", (".json", ".csv", ".ini.txt"), ["tune", self.one, "--state", "random-walk"])):
            for ending in others:
                refused(2, *command, option, folder / ("out" + ending), says=[f"{option}: is '{folder / ('out' + ending)}', expected a name ending in {good}"])
            assert not list(folder.iterdir()), list(folder.iterdir())
            for ending in (good, good.upper(), "", ".2026-11-23", "." + "aB3xYz"):  # mktemp's names have no format
                ifog(*command, option, folder / ("out" + ending))
                (folder / ("out" + ending)).unlink()
        kvh = ["--driver", "kvh1750"]
        refused(2, "replay", self.one, "--speed", 0, "--to", f"file:{folder / 'sent.csv'}", *kvh, says=["--to", "expected a name ending in .bin"])
        refused(2, "replay", self.one, "--speed", 0, "--to", f"file:{folder / 'sent.bin.gz'}", *kvh, says=["--to", "expected a name without .gz"])
        ifog("replay", self.one, "--speed", 0, "--to", f"file:{folder / 'sent.out'}", *kvh)
        assert [each.name for each in folder.iterdir()] == ["sent.out"]

    def check_a_capture_is_known_by_what_it_holds(self):
        """A CSV named .txt or without ending, and one in capitals."""
        def figures(capture):
            axes = json.loads(ifog("allan", capture, "--json", "-", "--tau", "1"))["axes"]
            return [{key: value for key, value in axis.items() if key != "capture"} for axis in axes]

        text, expected = self.one.read_bytes(), figures(self.one)
        for name in ("one.txt", "one", "one.dat", "one.asc", "ONE.CSV", "One.Csv"):
            (self.folder / name).write_bytes(text)
            assert figures(self.folder / name) == expected, name
        theirs = self.write("theirs.txt", "t;w", ";")
        refused(1, "allan", theirs, says=["theirs.txt:1: ", "--column rate_x_radps=NAME:UNIT"])
        ifog("convert", self.folder / "one.txt", self.folder / "one.kvh", "--driver", "kvh1750")
        (self.folder / "bytes.txt").write_bytes((self.folder / "one.kvh").read_bytes())
        refused(1, "allan", self.folder / "bytes.txt", says=["no capture in columns", "--driver NAME"])
        ifog("allan", self.folder / "bytes.txt", "--driver", "kvh1750", "--option", "rate_hz=100", "--axis", "x")

    def copied(self, line, folder):
        """Runs a printed command line in a shell in that folder."""
        assert line.startswith("ifog "), line
        there = self.folder / "bin"
        if not there.exists():
            there.mkdir()
            (there / "ifog").symlink_to(os.path.abspath(IFOG))
        done = subprocess.run(["bash", "-c", line], cwd=folder, env={**os.environ, "PATH": f"{there}:{os.environ['PATH']}"},
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120, check=False)
        assert done.returncode == 0, f"{line}: exit {done.returncode}: {done.stderr}"

    def check_a_container_of_another_program_says_what_makes_columns(self):
        """The first bytes according to the formats' descriptions."""
        for name, head, words in (("a.xlsx", b"PK\x03\x04", "spreadsheet"), ("a.mat", b"MATLAB 5.0 MAT-file, Platform: GLNXA64", "save -v7.3"),
                                  ("a.bag", b"#ROSBAG V2.0\n", "rostopic echo"), ("a.mcap", b"\x89MCAP0\r\n", "ros2 topic echo --csv"),
                                  ("a.db3", b"SQLite format 3\0", "ros2 topic echo --csv"), ("a.ulg", b"ULog\x01\x12\x35\x01", "ulog2csv"),
                                  ("a.bin", b"\xa3\x95\x80\x80\x59FMT", "mavlogdump.py"), ("a.npy", b"\x93NUMPY\x01\0v\0", "numpy.savetxt"),
                                  ("a.parquet", b"PAR1\x15\x04", "to_csv")):
            path = self.folder / name
            path.write_bytes(head + bytes(600))
            for command in (["allan"], ["denoise", "--output", self.folder / "x.csv"], ["tune"], ["diagnose"]):
                refused(1, command[0], path, *command[1:], says=[words, name])

    def check_commands_to_be_copied_run_as_they_stand(self):
        """With blanks and quotes in every name, and with the options used for reading the capture."""
        folder = self.folder / "it's a folder"
        folder.mkdir()
        capture, model, report = folder / 'a "b" $c.csv', folder / "the model.toml", folder / "report.html"
        capture.write_text(self.write("theirs.csv", "Time [ms];Gyro Z", ";").read_text())
        read_with = ["--separator", ";", "--column", "rate_radps=Gyro Z:rad/s", "--time", "Time [ms]:s"]
        tuned = ifog("tune", capture, *read_with, "--state", "random-walk", "--write-model", model)
        line = re.search(r"^to use it: (.*)$", tuned, re.M).group(1)
        self.copied(line, folder)
        assert (folder / "denoised.csv").stat().st_size > 0
        ifog("diagnose", "--quiet", capture, *read_with, "--write-model", model, "--report", report)
        page = report.read_text()
        lines = [html.unescape(text) for text in re.findall(r"<pre>(.*?)</pre>", page[page.index('id="apply"'):], re.S)]
        (folder / "next.csv").write_bytes(capture.read_bytes())
        commands = [line for line in lines if line.startswith("ifog ")]
        assert len(commands) >= 2 and "--separator" in commands[0], lines
        for line in commands:
            self.copied(line, folder)
        assert (folder / "corrected.csv").stat().st_size > 0
        ifog("diagnose", "--quiet", capture, *read_with, "--report", report)
        self.copied(html.unescape(re.findall(r"<pre>(ifog diagnose.*?)</pre>", report.read_text(), re.S)[0]), folder)
        assert (folder / "model.toml").stat().st_size > 0
        odd = folder / "flight 1.ifr"
        odd.write_bytes((SOURCE / "tests/stable/0.2.0/recording.ifr").read_bytes())
        said = ran("convert", odd, folder / "flight 1.bin")
        self.copied("ifog replay " + said.stderr.split("ifog replay ")[1].splitlines()[0], folder)
        assert (folder / "flight 1.bin").stat().st_size > 0

    def check_columns_without_a_header_are_one_line(self):
        """For every command that reads them, with any separator."""
        says = ["no header line", "--time '#1:s'", "rate_radps=#2:rad/s"]
        plain = self.write("plain.csv", "")
        packed = self.folder / "packed.csv.gz"
        packed.write_bytes(gzip.compress(plain.read_bytes()))
        for file in (plain, packed, self.write("semicolons.csv", "", ";"), self.write("tabs.csv", "", "\t")):
            for command in READERS:
                refused(1, command, file, says=[f"{file}:1: ", *says])
            refused(1, "denoise", file, "--output", self.folder / "never.csv", says=says)
            refused(1, "convert", file, self.folder / "never.h5", says=says)
            refused(1, "replay", file, "--to", "-", "--driver", "kvh1750", says=says)
        refused(1, "allan", plain, "--time", "t:s", "--column", "rate_radps=w:rad/s", says=["no column 't', the header has '#1', '#2'"])
        ifog("allan", plain, "--time", "#1:s", "--column", "rate_radps=#2:rad/s")
        # Numbers as names: a table that was written with numbered columns.
        ifog("allan", self.write("counted.csv", "0,1"), "--time", "0:s", "--column", "rate_radps=1:rad/s")
        assert not (self.folder / "never.csv").exists() and not (self.folder / "never.h5").exists()

    def check_a_row_without_a_value_is_no_gap(self):
        text = self.one.read_text().splitlines()
        empty, cut = self.folder / "empty.csv", self.folder / "cut.csv"
        empty.write_text("\n".join(line.split(",")[0] + "," if 100 < i <= 500 else line for i, line in enumerate(text)) + "\n")
        cut.write_text("\n".join(line for i, line in enumerate(text) if not 100 < i <= 500) + "\n")
        for path, warned, counted in ((empty, "rate is missing in 400 of 3000 rows", "3000 samples at 100 Hz, no gap between them\n"),
                                      (cut, "", "2600 samples at 100 Hz, 400 more lost in 1 gap\n"), (self.one, "", "3000 samples at 100 Hz, no gap between them\n")):
            done = ran("denoise", path, "--output", self.folder / "told.csv", "--process-noise", "1e-12", "--measurement-noise", "1e-10")
            assert done.returncode == 0 and counted in done.stdout and "missing" not in done.stdout, done
            assert (warned in done.stderr) if warned else not done.stderr, done.stderr

    def check_what_a_model_lacks_is_said_with_its_line(self):
        head = "version = 1\n\n[[effect]]\n"
        coefficient = '[[effect.parameter]]\nname = "coefficient"\nvalue = 1e-6\n'
        for name, keys, parts in (
                ("product", 'form = "product"\nchannel = "t_degC"\nwith_channel = "u_V"\nwith_form = "quadratc"\n', [":7: effect[1].with_form", "'quadratic'"]),
                ("channel", 'form = "linear"\nchannel = "temperature_degC"\n', ["'temperature_degC'" , "3"]),
                ("axis", 'form = "linear"\nchannel = "temperature_degC"\naxis = "q"\n', ["in line 3: the sensor has no axis 'q'"])):
            model = self.folder / f"{name}.toml"
            model.write_text(head + keys + coefficient)
            refused(1, "diagnose", self.one, "--model", model, says=[str(model), *parts])
            if name != "channel":
                refused(1, "denoise", self.one, "--model", model, "--output", self.folder / "never.csv", says=[str(model), *parts])
        refused(1, "denoise", self.one, "--model", self.folder / "channel.toml", "--output", self.folder / "never.csv",
                says=[f"{self.folder / 'channel.toml'}:3: ", "temperature_degC"])

    def check_a_name_with_control_characters_is_shown_and_can_be_copied(self):
        """Escaped on the terminal; the printed command still refers to the file."""
        folder = self.folder / "seen"
        folder.mkdir()
        capture, model = folder / "a\x1b[31m b\n.csv", folder / "m\x07 it's.toml"
        capture.write_text(self.write("coloured.csv", "Time \x1b[31m[ms];Gyro\x07 Z", ";").read_text())
        done = ran("tune", capture, "--separator", ";", "--column", "rate_radps=Gyro\x07 Z:rad/s", "--time", "Time \x1b[31m[ms]:s",
                   "--state", "random-walk", "--write-model", model)
        assert done.returncode == 0, done
        self.copied(re.search(r"^to use it: (.*)$", done.stdout, re.M).group(1), folder)
        assert (folder / "denoised.csv").stat().st_size > 0
        hinted = ran("allan", self.write("theirs \x1b.csv", "t_ms;Gyro\x07Z_degps", ";"))
        for said in (done.stdout + done.stderr, hinted.stdout + hinted.stderr, *(ran(*map(str, command)).stderr for command in (
                ["allan", capture], ["denoise", capture, "--output", folder / "x\x1b.mat"], ["monitor", "--lcm-url", "udpm://\x1b[31m"],
                ["allan", self.one, "--plot", "\x1b.pdf"], ["status", "--config", "\x1b\n"], ["replay", self.one, "--to", "\x1b:\n"]))):
            assert said and not [c for c in said if c != "\n" and not c.isprintable()], repr(said)

    def check_a_value_that_says_nothing_is_none(self):
        """An unset variable of a script: the run without it would not be intended."""
        out = self.folder / "nothing.csv"
        for option in ("--model", "--json", "--config", "--noise", "--driver", "--dbc", "--time", "--separator", "--group", "--channel", "--sensor"):
            refused(2, "denoise", self.one, "--output", out, option, "", says=[f"ifog denoise: {option}: is '', expected "])
        for option in ("--axis", "--json", "--tau"):
            refused(2, "allan", self.one, option, "", says=[f"ifog allan: {option}: is '', expected "])
        refused(2, "allan", "", says=["capture: is '', expected FILE"])
        refused(2, "allan", self.one, "--json", says=["--json: has no value, expected FILE\n"])
        refused(2, "allan", self.one, "--confidence", ".9", "--confidence", ".5", says=["--confidence: has 2 values, expected one\n"])
        refused(2, "replay", self.one, "--to", "-", "--parity", "1", says=["--parity: is '1', expected one of none, even, odd\n"])
        refused(2, "replay", self.one, "--to", "nowhere", says=["replay: --to: is 'nowhere', expected can:INTERFACE"])
        refused(2, "denoise", self.one, "--output", out, "--weights", "heavy", says=["--weights: is 'heavy', expected "])
        for command in ("monitor", "record --output " + str(self.folder / "heard")):
            refused(2, *command.split(" "), "--seconds", "0.1", "--lcm-url", "nonsense", says=[f"ifog {command.split(' ')[0]}: --lcm-url: is 'nonsense', expected "])
        refused(1, "picture", self.one, "--output", self.folder / "p.svg", says=["one.csv: is no log of lcm-logger"])
        assert not out.exists() and not (self.folder / "heard").exists()

    def check_what_cannot_be_written_is_known_before_the_work(self):
        """No first output together with a second one that fails."""
        place = self.folder / "place"
        place.mkdir()
        (place / "folder.json").mkdir()
        scenario, made = SOURCE / "tools/simulate/scenarios/rest.toml", place / "made.csv"
        for second in (place / "folder.json", place / "not there" / "x.json"):
            refused(1, "denoise", self.one, "--output", made, "--json", second, says=[str(second)])
            refused(1, "simulate", scenario, "--output", made, "--truth", second, says=[str(second)])
            refused(1, "tune", self.one, "--state", "random-walk", "--write-model", place / "made.toml", "--json", second, says=[str(second)])
            refused(1, "allan", self.one, "--plot", place / "made.svg", "--json", second, says=[str(second)])
        assert [each.name for each in place.iterdir()] == ["folder.json"]

    def check_help_is_a_command_too(self):
        assert ran("help").stdout == ran("--help").stdout
        for command in ("allan", "compare", "status"):
            result = ran("help", command)
            assert result.returncode == 0 and result.stdout == ran(command, "--help").stdout, command
        refused(2, "help", "alan", says=["unknown command 'alan'", "'allan'"])

    def check_help_is_laid_out(self):
        """No line that a terminal would break within a word, no two empty lines."""
        for command in ["", *re.findall(r"^  ([a-z]+) ", ifog("--help").split("Subcommands:")[1], re.M)]:
            text = ifog(*filter(None, [command, "--help"]))
            assert "\n\n\n" not in text, command
            for line in text.splitlines():
                assert len(line) <= 100 or line.startswith("  ifog "), f"{command}: {line}"

    def check_the_demo_refuses_before_it_builds(self):
        """An unusable or missing file: one line in the first second, and nothing is installed or built."""
        still = self.folder / "still.csv"
        still.write_text("time_s,rate_radps\n1,0\n1,0\n")
        for words, code, says in ((["--help"], 0, "tools/demo CAPTURE"), (["--fast"], 2, "'--fast'"), ([self.folder / "none.csv"], 2, "none.csv: no such file"),
                                  ([still], 2, "sample rate"), ([self.one, still], 2, "expected one capture")):
            result = subprocess.run([SOURCE / "tools/demo", *words], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=10, check=False)
            told = result.stderr if code else result.stdout
            assert result.returncode == code and says in told and (code == 0 or told.count("\n") == 1), (words, result)


if __name__ == "__main__":
    sys.exit(main_of(Checks))

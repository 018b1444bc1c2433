#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Messages instead of faults, lost files or ignored values: samples without a time, one file under two names, unusable rates, and
invalid values on the command line.

usage: said.py PATH_OF_IFOG SOURCE_DIR
"""
import json
import math
import os
import random
import re
import subprocess
import sys

import schema
from run import IFOG, SOURCE, columns, ifog, main_of, ran, refused

DBC = ["--dbc", SOURCE / "drivers/dbc/examples/ifogd_gyro.dbc", "--option", "signal=Rate_x"]
ROWS, RATE_HZ, SIGMA = 3000, 100, 1e-5
READERS = ("allan", "tune", "compare", "diagnose")


def said(*arguments):
    """Messages of a command that must succeed."""
    result = ran(*arguments)
    assert result.returncode == 0, f"ifog {' '.join(map(str, arguments))}: exit {result.returncode}: {result.stderr.strip()}"
    return result.stdout + result.stderr


class Checks:
    def __init__(self, folder):
        self.folder = folder
        self.random = random.Random(5)
        self.noise = [self.random.gauss(0, SIGMA) for _ in range(ROWS)]
        self.one = self.write("one.csv", {"rate_radps": self.noise})

    def write(self, name, rates, times=None):
        path = self.folder / name
        length = len(next(iter(rates.values())))
        times = times or [i / RATE_HZ for i in range(length)]
        rows = (",".join([repr(t), *map(repr, values)]) for t, *values in zip(times, *rates.values()))
        path.write_text("\n".join([",".join(["time_s", *rates]), *rows]) + "\n")
        return path

    def model(self, name, axis=""):
        """Linear in the temperature between 20 and 20.5 °C."""
        path = self.folder / name
        path.write_text('version = 1\n[[effect]]\nform = "linear"\n' + (f'axis = "{axis}"\n' if axis else "")
                        + 'channel = "temperature_degC"\nreference = 20\n[[effect.parameter]]\nname = "coefficient"\nvalue = 1e-6\n'
                        + 'unit = "rad/s/degC"\n[[range]]\nchannel = "temperature_degC"\nlow = 20.0\nhigh = 20.5\n')
        return path

    def check_samples_without_a_time_are_one_line(self):
        """An exception of a sink must not reach the plugin's C functions: every command that reads, every kind of bytes."""
        log, trigger = self.folder / "untimed.log", self.folder / "trigger.bin"
        # As candump prints frames on a screen.
        log.write_text("  vcan0  100   [8]  00 00 00 00 00 00 00 00\n  vcan0  100   [8]  00 00 00 00 00 01 00 00\n")
        ifog("convert", self.one, trigger, "--driver", "stim300", "--option", "rate_hz=125")
        for source, options in ((log, DBC), (trigger, ["--driver", "stim300", "--option", "rate_hz=trigger"])):
            for command in (*READERS, "convert", "hdf5"):
                to = {"convert": [self.folder / "never.csv"], "hdf5": [self.folder / "never.h5"]}.get(command, [])
                refused(1, "convert" if to else command, source, *to, *options, says=[str(source), "carry no time", "rate_hz"])
            refused(1, "denoise", source, "--output", self.folder / "never.csv", *options, says=[str(source), "rate_hz"])
        assert not (self.folder / "never.csv").exists()
        ifog("convert", self.one, log, *DBC, "--option", "rate_hz=100")  # of `candump -L`, whose lines have times: they give the rate
        assert f"{ROWS} samples at 100 Hz" in said("denoise", log, "--output", self.folder / "timed.csv", *DBC)

    def check_no_output_is_another_file_of_the_run(self):
        """By device and inode, so also through symbolic and hard links, and for a file that does not exist yet."""
        before = self.one.read_bytes()
        link, hard, new = self.folder / "link.csv", self.folder / "hard.csv", self.folder / "new"
        link.symlink_to(self.one)
        os.link(self.one, hard)
        dangling = self.folder / "dangling"
        dangling.symlink_to(new)
        model = self.model("clash.toml")
        scenario = self.folder / "clash_scenario.toml"
        scenario.write_text("seed = 1\nsample_rate_hz = 50\nduration_s = 10\n[noise]\nN = 1e-6\n")
        tune = ["tune", self.one, "--state", "random-walk"]
        for path in (self.one, link, hard):
            refused(2, "denoise", self.one, "--output", path, says=["--output", "CAPTURE", "expected another"])
            refused(2, "allan", self.one, "--json", path, says=["--json", "capture"])
            refused(2, "convert", self.one, path, says=["TO", "FROM"])
        refused(2, "denoise", self.one, "--model", model, "--output", model, says=["--model", "--output"])
        dbc = self.folder / "bus.dbc"
        dbc.write_bytes(DBC[1].read_bytes())
        refused(2, "convert", self.one, dbc, "--dbc", dbc, "--option", "signal=Rate_x", says=["--dbc", "TO"])
        for other in (new, dangling):
            refused(2, "denoise", self.one, "--output", new, "--json", other, says=["--json", "--output"])
            refused(2, *tune, "--write-model", new, "--json", other, says=["--json", "--write-model"])
            refused(2, "simulate", scenario, "--output", new, "--truth", other, says=["--truth", "--output"])
            refused(2, "diagnose", self.one, "--write-model", new, "--report", other, says=["--report", "--write-model"])
        refused(2, "simulate", scenario, "--output", scenario, says=["SCENARIO", "--output"])
        refused(2, "replay", self.one, "--to", f"file:{self.one}", "--speed", "0", *DBC, says=["--to", "capture"])
        # A file opened by the shell counts as well.
        with open(self.one, "rb") as opened:
            done = subprocess.run([IFOG, "denoise", "-", "--output", str(self.one)], stdin=opened, capture_output=True, text=True, check=False)
        assert done.returncode == 2, done
        assert self.one.read_bytes() == before and not new.exists()
        # A device cannot be lost.
        ifog("denoise", self.one, "--output", "/dev/null", "--json", "/dev/null")

    def check_a_rate_that_is_missing_is_said_by_every_command(self):
        part = [math.nan if 500 <= i < 800 else v for i, v in enumerate(self.noise)]
        holed = self.write("holed.csv", {"rate_radps": part})
        words = re.compile(r"rate is missing in 300 of 3000 rows, first at 5 s")
        for command in (*READERS, "denoise"):
            out = ["--output", self.folder / "holed.out.csv"] if command == "denoise" else []
            text = said(command, holed, *out)
            assert words.search(text), f"{command}: {text}"
        dead = [math.nan] * ROWS
        for name, rates in (("dead.csv", {"rate_radps": dead}), ("dead3.csv", {"rate_x_radps": dead, "rate_y_radps": dead})):
            path = self.write(name, rates)
            for command in (*READERS, "denoise"):
                out = ["--output", self.folder / "never.csv"] if command == "denoise" else []
                refused(1, command, path, *out, says=[str(path), "no axis has a value in any of 3000 rows"])
        assert not (self.folder / "never.csv").exists()

    def check_an_axis_without_a_value_is_left_out(self):
        """The other axes are treated as if alone, and the dead one has no figures."""
        other = [self.random.gauss(0, SIGMA) for _ in range(ROWS)]
        path = self.write("dead_y.csv", {"rate_x_radps": self.noise, "rate_y_radps": [math.nan] * ROWS, "rate_z_radps": other})
        alone = self.write("without_y.csv", {"rate_x_radps": self.noise, "rate_z_radps": other})
        for command in (*READERS, "denoise"):
            documents = []
            for capture in (path, alone):
                to = self.folder / "axes.json"
                out = ["--output", self.folder / "axes.csv"] if command == "denoise" else []
                text = said(command, capture, *out, "--json", to)
                assert ("rate_y is missing in all 3000 rows: the axis is dropped" in text) == (capture == path), f"{command}: {text}"
                document = json.loads(to.read_text())
                schema.check(document)
                documents.append(json.loads(json.dumps(document).replace(str(path), str(alone))))
            assert documents[0] == documents[1], f"{command}: another result than without the dead axis"
        assert "raw_y_radps" not in columns(self.folder / "axes.csv")

    def check_an_axis_that_repeats_one_value_is_left_out_of_fits(self):
        """The other axes are fitted as if alone, even if a correction would make the stuck one vary."""
        other = [self.random.gauss(0, SIGMA) for _ in range(ROWS)]
        warm = {"temperature_degC": [20 + 0.4 * math.sin(i / 100) for i in range(ROWS)]}
        rates = {"rate_x_radps": self.noise, "rate_y_radps": [1e-4] * ROWS, "rate_z_radps": other}
        path = self.write("stuck_y.csv", rates | warm)
        alone = self.write("not_y.csv", {name: rate for name, rate in rates.items() if "_y_" not in name} | warm)
        tune = ["tune", "--state", "random-walk"]
        for command in (tune, ["compare"], ["diagnose"], ["diagnose", "--model", self.model("of_all.toml")]):
            documents = []
            for capture in (path, alone):
                to = self.folder / "stuck.json"
                text = said(*command, capture, "--json", to)
                assert (f"{path}: rate_y is 0.0001 rad/s in all of its {ROWS} rows: the axis is stuck, and dropped" in text) == (capture == path), text
                documents.append(json.loads(json.dumps(json.loads(to.read_text())).replace(str(path), str(alone))))
            assert documents[0] == documents[1], f"{command}: another result than without the stuck axis"
        noise = []
        for capture in (path, alone):
            to = self.folder / "stuck.json"
            text = said("denoise", capture, "--output", self.folder / "stuck.out.csv", "--json", to)
            assert (f"rate_y repeats one value in {ROWS - 100} of {ROWS} rows" in text) == (capture == path), text
            document = json.loads(to.read_text())
            schema.check(document)
            assert [axis["stuck"] for axis in document["axes"]] == ([0, ROWS - 100, 0] if capture == path else [0, 0])
            noise.append(document["filter"]["measurement_noise"])
        assert noise[0] == noise[1], f"the noise of a start-up with a stuck axis is {noise[0]}, without {noise[1]}"
        # If no other axis is left, the error message describes the rates.
        for command in (tune, ["diagnose"]):
            refused(1, *command, self.write("still.csv", {"rate_radps": [1e-4] * ROWS}), says=["still.csv"])

    def check_a_model_of_an_axis_without_a_value_corrects_the_others(self):
        other = [self.random.gauss(0, SIGMA) for _ in range(ROWS)]
        warm = {"temperature_degC": [20 + i / 10000 for i in range(ROWS)]}
        dead = self.write("dead_y_warm.csv", {"rate_x_radps": self.noise, "rate_y_radps": [math.nan] * ROWS, "rate_z_radps": other} | warm)
        alone = self.write("no_y_warm.csv", {"rate_x_radps": self.noise, "rate_z_radps": other} | warm)
        model, of_x = self.folder / "xyz.toml", self.model("only_x.toml", "x")
        effect = of_x.read_text().split("[[effect]]")[1].split("[[range]]")
        model.write_text("version = 1\n" + "".join("[[effect]]" + effect[0].replace('"x"', f'"{axis}"') for axis in "xy") + "[[range]]" + effect[1])
        outs = []
        for capture, of in ((dead, model), (alone, of_x)):
            outs.append(self.folder / "corrected.csv")
            text = said("denoise", capture, "--model", of, "--output", outs[-1])
            outs[-1] = outs[-1].read_text()
        assert outs[0] == outs[1], "another correction than of a capture without that axis"
        refused(1, "denoise", alone, "--model", model, "--output", self.folder / "never.csv", says=[str(model), "no axis 'y'"])

    def check_figures_are_of_the_part_that_is_wanted(self):
        """The noise is known after 4096 samples; values are missing from 50 to 53 s."""
        rows = [self.random.gauss(0, SIGMA) for _ in range(10000)]
        part = [math.nan if 5000 <= i < 5300 else v for i, v in enumerate(rows)]
        holed, out, to = self.write("parts.csv", {"rate_radps": part}), self.folder / "parts.out.csv", self.folder / "parts.json"
        for bounds, samples, unknown, invalid in (([], 10000, 4096, 300), (["--to", 30], 3000, 3000, 0), (["--from", 51], 4900, 0, 200),
                                                  (["--from", 60], 4000, 0, 0), (["--from", 20, "--to", 51], 3100, 2096, 100)):
            text = said("denoise", holed, *bounds, "--output", out, "--json", to)
            found = json.loads(to.read_text())
            figures = [found[key] for key in ("samples", "samples_before_noise_known", "invalid")]
            assert figures == [samples, unknown, invalid], f"{bounds}: {figures}"
            none = unknown == samples
            assert found["filter"]["from_start_up"] != none and ("before the noise is known" in text) == none, text

    def check_numbers_too_small_for_a_double_are_zero(self):
        tiny = self.folder / "tiny.csv"
        tiny.write_text("time_s,rate_radps\n" + "".join(f"{i / RATE_HZ},{v if i % 3 else '1e-400'}\n" for i, v in enumerate(self.noise)))
        out = self.folder / "tiny.out.csv"
        ifog("denoise", tiny, "--output", out)
        assert columns(out)["raw_radps"][0] == 0.0
        for value in ("1e-310", "1e-400"):
            result = ran("denoise", self.one, "--output", out, "--process-noise", value, "--measurement-noise", "1e-10")
            assert result.returncode == 0, result

    def check_what_a_configuration_names_is_read(self):
        """Relative to it, regardless of other options, and not an output of the run."""
        place = self.folder / "configured"
        place.mkdir()
        dbc, model, config = place / "bus.dbc", self.model("configured/model.toml"), place / "ifogd.toml"
        dbc.write_bytes(DBC[1].read_bytes())
        config.write_text('[[sensor]]\nname = "nose"\ndriver = "dbc"\n[sensor.transport]\ntype = "file"\npath = "can.log"\nformat = "candump"\n'
                          '[sensor.options]\ndbc = "bus.dbc"\nsignal = "Rate_x"\nrate_hz = 50\n')
        log = place / "can.log"
        ifog("convert", self.one, log, "--dbc", dbc, "--option", "signal=Rate_x", "--option", "rate_hz=100")
        before = [path.read_bytes() for path in (dbc, log, config)]
        out, to = self.folder / "configured.csv", self.folder / "configured.json"
        denoise = ["denoise", log, "--config", config]
        ifog(*denoise, "--output", out, "--option", "rate_hz=100", "--json", to)
        assert json.loads(to.read_text())["sample_rate_hz"] == 100
        for path in (dbc, log, config):
            refused(2, *denoise, "--output", path, says=["expected another one"])
            refused(2, *denoise, "--output", out, "--json", path, says=["expected another one"])
        refused(2, "proposals", "--config", config, "--json", dbc, says=["option dbc of sensor nose", "expected another one"])
        assert [path.read_bytes() for path in (dbc, log, config)] == before
        text = config.read_text().replace("driver = ", f'model = "{model}"\ndriver = ')
        config.write_text(text)
        refused(2, *denoise, "--output", model, says=["the configuration's model", "expected another one"])

    def check_a_drivers_axis_without_a_value_has_no_figures(self):
        frames, out, summary = self.folder / "x.kvh", self.folder / "x.csv", self.folder / "x.json"
        ifog("convert", self.one, frames, "--driver", "kvh1750", "--option", "rate_hz=100")
        text = said("denoise", frames, "--driver", "kvh1750", "--option", "rate_hz=100", "--output", out, "--json", summary)
        assert "axis y: no value" in text and "std raw 0," not in text, text
        document = json.loads(summary.read_text())
        schema.check(document)
        assert [axis["missing"] for axis in document["axes"]] == [0, ROWS, ROWS], document["axes"]
        assert document["axes"][1]["raw_std_radps"] is None
        found = columns(out)
        assert all(math.isnan(value) for name in ("denoised_y_radps", "variance_z_rad2ps2") for value in found[name]), "a rate that nobody measured"
        assert not any(math.isnan(value) for value in found["denoised_x_radps"])

    def check_full_scale_is_the_same_everywhere(self):
        """convert and allan treat the values that the daemon treats as missing, by the driver's full scale, as missing too, and
        report it."""
        fast = [12.0 if 1000 <= i < 1100 else v for i, v in enumerate(self.noise)]
        options = ["--driver", "kvh1750", "--option", "rate_hz=100"]
        path, frames, back = self.write("fast.csv", {"rate_radps": fast}), self.folder / "fast.kvh", self.folder / "fast.back.csv"
        assert "100 samples at or beyond the sensor's full scale" in said("convert", path, frames, *options)
        denoised = self.folder / "fast.out.csv"
        for command in (["convert", frames, back], ["allan", frames], ["denoise", frames, "--output", denoised]):
            text = said(*command, *options)
            assert "100 samples at or beyond the sensor's full scale, treated as missing" in text, f"{command}: {text}"
        for file, column in ((back, "rate_x_radps"), (denoised, "raw_x_radps")):
            missing = [i for i, value in enumerate(columns(file)[column]) if math.isnan(value)]
            assert missing == list(range(1000, 1100)), f"{file}: {missing[:3]} … {len(missing)}"

    def check_what_makes_bytes_of_a_flight_recording_is_named(self):
        """The output has the samples of the recording."""
        recording, to = SOURCE / "tests/stable/0.2.0/recording.ifr", self.folder / "flight.bin"
        result = ran("convert", recording, to)
        assert result.returncode == 2, f"exit {result.returncode}: {result.stderr}"
        command = result.stderr.split("ifog replay ")[1].splitlines()[0].split()
        assert command == [str(recording), "--speed", "0", "--to", f"file:{to}"], result.stderr
        said("replay", *command)
        assert to.stat().st_size > 0

    def check_a_record_counts_once(self):
        copy, packed = self.folder / "copy.csv", self.folder / "copy.csv.gz"
        copy.write_bytes(self.one.read_bytes())
        ifog("convert", self.one, packed)
        for again in (self.one, copy, packed):
            refused(1, "diagnose", self.one, again, says=[str(again), "the same samples as", str(self.one)])
        times = [i / RATE_HZ for i in range(ROWS)]
        for name, begin, end, said_from, said_to in (("tail.csv", 1000, 3000, "10", "19.99"), ("inside.csv", 500, 1500, "5", "14.99")):
            part = self.write(name, {"rate_radps": self.noise[begin:end]}, times[begin:end])
            whole = self.write("front.csv", {"rate_radps": self.noise[:2000]}, times[:2000])
            refused(1, "diagnose", whole, part, says=[str(part), f"from {said_from} to {said_to} s", "expected each record once"])
        # Different records may begin at the same time.
        ifog("diagnose", "--quiet", self.one, self.write("another.csv", {"rate_radps": [self.random.gauss(0, SIGMA) for _ in range(ROWS)]}))

    def check_a_model_of_one_axis_for_several_is_said(self):
        warm = {"temperature_degC": [20 + i / 10000 for i in range(ROWS)]}
        one = self.write("warm.csv", {"rate_radps": self.noise, **warm})
        three = self.write("three.csv", {f"rate_{a}_radps": [self.random.gauss(0, SIGMA) for _ in range(ROWS)] for a in "xyz"} | warm)
        out = ["--output", self.folder / "three.out.csv"]
        for name, axis, is_said in (("one_axis.toml", "", True), ("named.toml", "x", False)):
            model = self.model(name, axis)
            text = said("denoise", three, "--model", model, *out)
            assert ("subtracted from each of x, y, z" in text) == is_said, text
        assert "each of" not in said("denoise", one, "--model", self.model("one_axis.toml"), *out)

    def check_a_correction_that_is_not_there_is_said(self):
        """At rest; `share` of the model's correction is in the data. On an oscillating table the rate is not an error."""
        times = [float(i) for i in range(1200)]
        swing = [0.25 * math.sin(t / 30) for t in times]
        model, out = self.model("share.toml"), self.folder / "share.json"
        for share, table, denied in ((1, 0, False), (0, 0, True), (0, 0.01, False)):
            rate = [1e-7 * self.random.gauss(0, 1) + share * 1e-6 * s + table * math.sin(t / 20) for s, t in zip(swing, times)]
            path = self.write("share.csv", {"rate_radps": rate, "temperature_degC": [20.25 + s for s in swing]}, times)
            text = said("denoise", path, "--model", model, "--output", self.folder / "out.csv", "--json", out)
            assert ("of what the model corrects is in this capture" in text) == denied, text
            axis = json.loads(out.read_text())["axes"][0]
            assert ("model_share" in axis) == (table == 0), axis
            assert table or abs(axis["model_share"] - share) < 4 * axis["model_share_error"] < 0.2, axis

    def check_a_models_channel_that_is_missing_is_said(self):
        rates = {"rate_radps": self.noise, "temperature_degC": [math.nan if i > 1000 else 20 + i / 1000 for i in range(ROWS)]}
        path, out = self.write("cold.csv", rates), ["--output", self.folder / "cold.out.csv"]
        text = said("denoise", path, "--model", self.model("linear.toml"), *out)
        assert "channel that the model wants" in text and "outside the range" in text, text
        assert "the model" not in said("denoise", path, *out)

    def check_a_model_that_does_not_hold_beside_a_reference_is_said(self):
        """A temperature that no longer acts as the model has it; a model that helps, or changes the bias by less than it wanders, is not one."""
        truth = [1e-3 * math.sin(0.01 * i) for i in range(ROWS)]
        warm = [20 + 0.5 * math.sin(0.003 * i) for i in range(ROWS)]
        for slope, holds in ((1e-6, True), (-1e-6, False), (0.0, False)):
            rate = [t + slope * (w - 20) + 0.01 * n for t, w, n in zip(truth, warm, self.noise)]
            path = self.write(f"beside_{slope}.csv", {"rate_radps": rate, "reference_rate_radps": truth, "temperature_degC": warm})
            text = said("denoise", path, "--model", self.model("warm.toml"), "--output", self.folder / "beside_out.csv")
            assert ("the model does not hold here" in text) != holds, f"{slope}: {text}"

    def check_every_number_is_finite(self):
        """For every command, from its own description: an option with a numeric value accepts nothing else."""
        numbers, words = {"NUMBER", "SECONDS", "S", "TIME"}, {"N", "INDEX"}
        texts = {"FILE", "NAME", "FOLDER", "WHERE", "URL", "PATH", "C", "KEY=VALUE", "HEADER[:UNIT]", "NAME=HEADER[:UNIT]", "HEADER=VALUE", "WHAT", "[ADDRESS:]PORT"}
        tried = 0
        for command in json.loads(ifog("--describe"))["commands"]:
            for option in command["options"]:
                value = option["value"]
                if not option["names"] or not value or option["choices"]:
                    continue
                assert value in numbers | words | texts, f"{command['name']} {option['names']}: value {value} is neither a number nor a text here"
                if value in texts:
                    continue
                for bad in ("nan", "inf", "1x", *(("1.5", "99999999999999999999") if value in words else ("1e999",))):
                    result = ran(command["name"], self.one, f"{option['names'][-1]}={bad}")
                    line = result.stderr.splitlines()[0] if result.stderr else ""
                    assert result.returncode == 2 and f"is '{bad}', expected a " in line, f"{command['name']} {option['names']} {bad}: {result}"
                    tried += 1
        assert tried > 150, tried

    def check_values_are_refused_with_what_was_expected(self):
        denoise = ["denoise", self.one, "--output", self.folder / "never.csv"]
        for arguments, parts in (
                (["allan", self.one, "--tau", "0"], ["--tau: is '0', expected a number more than 0"]),
                (["replay", self.one, "--to", "-", "--speed", "-1"], ["--speed: is '-1', expected a number 0 or more"]),
                (["allan", self.one, "--confidence", "2"], ["--confidence: is '2', expected a number 0.01 to 0.9999"]),
                (["allan", self.one, "--estimator", "x"], ["--estimator: is 'x', expected one of overlapping, modified, hadamard"]),
                ([*denoise, "--filter", "foo"], ["--filter: is 'foo', expected one of ckf", "irwe-akfg"]),
                ([*denoise, "--state", "foo"], ["--state: is 'foo', expected one of random-walk", "ar(p)"]),
                ([*denoise, "--state", "ar"], ["--state: is 'ar', expected one of"]),
                ([*denoise, "--window", "1.5"], ["--window: is '1.5', expected a whole number 2 ... 100000"]),
                ([*denoise, "--window", "1"], ["--window: is '1', expected a whole number 2 ... 100000"]),
                ([*denoise, "--sequence", "-1"], ["--sequence: is '-1', expected a whole number 0 or more"]),
                ([*denoise, "--sensor", "x"], ["--sensor: is 'x', expected --config"])):
            refused(2, *arguments, says=parts)
        refused(1, "diagnose", self.one, "--axis", "q", says=[f"{self.one}: --axis is 'q', expected none"])
        refused(1, "allan", self.one, "--axis", "x", says=[f"{self.one}: --axis is 'x', expected none"])
        model = self.model("of_q.toml", "q")
        for command in (denoise, ["diagnose", self.one]):
            refused(1, *command, "--model", model, says=[str(model), "no axis 'q'"])
        assert "--rate is 50 Hz" in said("denoise", self.one, "--rate", "50", "--output", self.folder / "rate.csv")
        tiny = self.folder / "tiny.toml"
        tiny.write_text("seed = 1\nsample_rate_hz = 1\nduration_s = 1\n[noise]\nN = 1e-6\n")
        refused(1, "simulate", tiny, "--output", self.folder / "never.csv", says=["tiny.toml", "duration_s", "1.0", "expected 2"])

    def check_tune_counts_rows(self):
        """A gap of a day between two runs does not produce rows."""
        day = self.write("day.csv", {"rate_radps": self.noise[:2000]}, [i / RATE_HZ + (86400 if i >= 1000 else 0) for i in range(2000)])
        for most, left in ((2000, 0), (1500, 500)):
            to = self.folder / "day.json"
            text = said("tune", day, "--samples", most, "--state", "random-walk", "--json", to)
            assert json.loads(to.read_text())["left_out"] == left
            assert ("--samples 2000 takes all" in text) == (left > 0), text

    def check_time_that_a_format_loses_is_said(self):
        holed = self.write("hole.csv", {"rate_radps": self.noise}, [i / RATE_HZ + (20 if i >= 1000 else 0) for i in range(ROWS)])
        kvh = ["--driver", "kvh1750", "--option", "rate_hz=100"]
        for path, options, lost in ((holed, [*kvh, "--option", "format=a"], True), (holed, [*kvh, "--option", "format=b"], False),
                                    (self.one, [*kvh, "--option", "format=a"], False),
                                    (self.one, ["--driver", "stim300", "--option", "rate_hz=125"], True)):
            frames, back = self.folder / "lost.bin", self.folder / "lost.csv"
            text = said("convert", path, frames, *options)
            ifog("convert", frames, back, *options)
            time, told = columns(path)["time_s"], columns(back)["time_s"]
            differs = abs((time[-1] - time[0]) - (told[-1] - told[0])) > 0.02
            assert differs == lost, f"{options}: {time[-1] - time[0]} s, back {told[-1] - told[0]} s"
            assert ("the format has no clock" in text) == lost, f"{options}: {text}"


if __name__ == "__main__":
    sys.exit(main_of(Checks))

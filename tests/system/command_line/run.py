#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The command line as used by other programs: JSON and CSV, exit codes, one clear line for bad input.

usage: run.py PATH_OF_IFOG SOURCE_DIR

Expected numbers come from the simulated scenario and from closed forms, not from the program.
"""
import csv
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile

import schema

IFOG, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
RATE_HZ, SECONDS, N, BIAS, PER_DEGREE = 50, 400, 2.5e-7, 5e-5, 4e-6
SCENARIO = f"""
seed = 3
sample_rate_hz = {RATE_HZ}
duration_s = {SECONDS}
bias_radps = {BIAS}
[noise]
N = {N}
[[channel]]
name = "temperature_degC"
shape = "cycle"
level = 27.0
amplitude = 3.0
period_s = 160
[[effect]]
form = "linear"
channel = "temperature_degC"
coefficient = {PER_DEGREE}
reference = 25.0
"""


def ran(*arguments):
    return subprocess.run([IFOG, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, timeout=120, check=False)


def ifog(*arguments):
    result = ran(*arguments)
    assert result.returncode == 0, f"ifog {' '.join(map(str, arguments))}: exit {result.returncode}: {result.stderr.strip()}"
    return result.stdout


def refused(code, *says_and_arguments, says):
    """One line on standard error that contains all parts of `says`."""
    result = ran(*says_and_arguments)
    said = result.stderr.strip()
    assert result.returncode == code, f"{says_and_arguments}: exit {result.returncode}, expected {code}: {said}"
    if code == 1:
        assert len(said.splitlines()) == 1, f"{says_and_arguments}: more than one line: {said}"
    for part in says:
        assert part in said, f"{says_and_arguments}: '{part}' is not in '{said}'"


def columns(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {name: [float(row[name]) if row[name] not in ("", "nan") else math.nan for row in rows] for name in rows[0]}


def has(where, *keys):
    missing = [key for key in keys if key not in where]
    assert not missing, f"no {missing} in {sorted(where)}"


def near(value, expected, tolerance, what):
    assert abs(value - expected) <= tolerance, f"{what} is {value}, expected {expected} ± {tolerance}"


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


class Checks:
    def __init__(self, folder):
        self.folder = folder
        (folder / "rest.toml").write_text(SCENARIO)
        self.capture = folder / "rest.csv"
        ifog("simulate", folder / "rest.toml", "--output", self.capture, "--truth", folder / "truth.json")

    def json(self, command, *arguments):
        path = self.folder / f"{command}.json"
        ifog(command, *arguments, "--json", path)
        document = json.loads(path.read_text())
        schema.check(document)
        return document

    def check_simulate_hides_the_truth(self):
        truth = json.loads((self.folder / "truth.json").read_text())
        assert truth["effects"][0]["kind"] == "linear" and truth["noise"]["N"] == N
        text = self.capture.read_text()
        for secret in ("linear", "seed", "bias", repr(N), "coefficient"):
            assert secret not in text, f"the capture says '{secret}'"
        assert len(columns(self.capture)["time_s"]) == RATE_HZ * SECONDS

    def check_simulate_writes_frames(self):
        """The same capture as bytes of each driver and as candump log, to the precision of float32 or half a count."""
        rate = columns(self.capture)["rate_radps"]
        for name, half_a_count, options in (
                ("rest.kvh", 0, ["--driver", "kvh1750"]), ("rest.stdbin", 0, ["--driver", "stdbin"]),
                ("rest.sbg", 0.5 / 2**26, ["--driver", "sbgecom"]),
                ("rest.log", 0, ["--dbc", SOURCE / "drivers/dbc/examples/ifogd_gyro.dbc", "--option", "signal=Rate_x",
                                 "--option", "counter=Counter", "--option", f"rate_hz={RATE_HZ}"])):
            frames, back = self.folder / name, self.folder / (name + ".csv")
            ifog("simulate", self.folder / "rest.toml", "--output", frames, *options)
            ifog("convert", frames, back, *options)
            decoded = columns(back)
            found = decoded.get("rate_radps") or decoded["rate_x_radps"]
            assert len(found) == len(rate), f"{name}: {len(found)} samples of {len(rate)}"
            worst = max(abs(a - b) for a, b in zip(rate, found))
            assert worst <= 1.2e-7 * max(map(abs, rate)) + half_a_count, f"{name}: differs by {worst}"

    def check_any_csv(self):
        """A file of another maker: other names, units, separator, decimal commas, byte-order mark; with the same result."""
        theirs, ours = self.folder / "theirs.txt", self.folder / "ours.csv"
        rows = [(20 * i, 0.01 * math.sin(0.1 * i), 68 + 0.1 * i) for i in range(500)]
        cells = "".join(f"{t};{rate};{degf:.1f};ok\n".replace(".", ",") for t, rate, degf in rows)
        theirs.write_text("\ufefft;GyroX;T;state\n" + cells, encoding="utf-8")
        chosen = ["--separator", ";", "--time", "t:ms", "--column", "rate_x_radps=GyroX:deg/s", "--column", "temperature_degC=T:degF"]
        ifog("convert", theirs, ours, *chosen)
        found = columns(ours)
        assert list(found) == ["time_s", "rate_x_radps", "temperature_degC"], list(found)
        for time, rate, degc, (t, dps, degf) in zip(*found.values(), rows):
            near(time, t / 1000, 1e-12, "time")
            near(rate, math.radians(dps), 1e-15, "rate")
            near(degc, (degf - 32) / 1.8, 1e-9, "temperature")
        direct, converted = (self.json("allan", path, *options, "--tau", "1")["axes"][0]
                             for path, options in ((theirs, chosen), (ours, ["--axis", "x"])))
        for key in ("axis", "adev_radps", "coefficients"):
            assert direct[key] == converted[key], key
        refused = subprocess.run([IFOG, "allan", theirs, "--separator", ";", "--column", "temperature_degC=T:V"], capture_output=True, text=True)
        assert refused.returncode == 2 and "degC, degF, K" in refused.stderr, refused

    def check_allan(self):
        """White noise only: sigma(tau) = N / sqrt(tau), and no other term."""
        (self.folder / "white.toml").write_text(SCENARIO.split("[[channel]]")[0])
        ifog("simulate", self.folder / "white.toml", "--output", self.folder / "white.csv")
        found = self.json("allan", self.folder / "white.csv", "--tau", "0.1,1,10")
        assert found["schema"] == "ifog.allan/1"
        near(found["sample_rate_hz"], RATE_HZ, 1e-6, "sample rate")
        axis = found["axes"][0]
        has(axis, "axis", "tau_s", "adev_radps", "lower_radps", "upper_radps", "coefficients")
        assert axis["tau_s"] == [0.1, 1, 10], axis["tau_s"]
        for tau, sigma, low, high in zip(axis["tau_s"], axis["adev_radps"], axis["lower_radps"], axis["upper_radps"]):
            # Relative error of an overlapping estimate, 1 / sqrt(2 edf), edf about 1.5 T / tau; four of them.
            near(sigma, N / math.sqrt(tau), 4 * N / math.sqrt(tau) / math.sqrt(3 * SECONDS / tau), f"sigma({tau})")
            assert low < sigma < high
        for name in "QNBKR":
            term = axis["coefficients"][name]
            has(term, "value", "std_error", "unit", "present")
            assert term["present"] == (name == "N"), f"{name} present: {term['present']}"
        near(axis["coefficients"]["N"]["value"], N, 4 * axis["coefficients"]["N"]["std_error"], "N")

    def check_allan_with_holes(self):
        """A long gap and a missing value: reported, divided by and filled, or rejected with the line if requested."""
        lines = (self.folder / "white.csv").read_text().splitlines()
        header = next(i for i, line in enumerate(lines) if line.startswith("time_s"))
        del lines[header + 5001:header + 5501]
        lines[header + 9001] = lines[header + 9001].split(",")[0] + ","
        holes = self.folder / "holes.csv"
        holes.write_text("\n".join(lines) + "\n")
        said = ifog("allan", holes)
        for part in ("1 gap", "500 samples missing", "missing in 1 of 19500 rows", "across 1 missing sample,", "2 stretches"):
            assert part in said, f"'{part}' is not in: {said[:600]}"
        # The gap is after data row 5000, whose line is header + 5001 counted from one.
        refused(1, "allan", holes, "--gaps", "refuse", says=[f"{holes}:{header + 5001}: 1 gap"])
        found = self.json("allan", holes, "--tau", "1")
        near(found["axes"][0]["adev_radps"][0], N, 0.12 * N, "sigma(1 s) around holes")

    def check_allan_before_and_after(self):
        """Several captures, one of them denoised, in one picture."""
        denoised, picture = self.folder / "denoised.csv", self.folder / "allan.svg"
        ifog("denoise", self.capture, "--output", denoised)
        ifog("allan", self.capture, denoised, "--plot", picture)
        assert picture.read_text().rstrip().endswith("</svg>")

    def check_allan_leaves_out_the_start_of_a_filter(self):
        """As noisy as the sensor for 4 s, then a hundredth of it: the figures are those of the running filter."""
        random.seed(11)
        path = self.folder / "started.csv"
        rows = []
        for i in range(20000):
            z = random.gauss(0.0, 1e-5)
            out = z if i < 400 else random.gauss(0.0, 1e-7)
            rows.append(f"{i / 100},{z!r},{z!r},{out!r}\n")
        path.write_text("time_s,raw_radps,compensated_radps,denoised_radps\n" + "".join(rows))
        done = subprocess.run([IFOG, "allan", path, "--tau", "0.01", "--json", self.folder / "started.json"], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        said = done.stdout + done.stderr
        assert "denoised_radps: until 4 s the filter had not started" in said and "leap" not in said, said
        found = {axis["signal"]: axis for axis in json.loads((self.folder / "started.json").read_text())["axes"]}
        near(found["denoised"]["adev_radps"][0], 1e-7, 3e-9, "deviation of the filter that runs")
        near(found["compensated"]["adev_radps"][0], 1e-5, 3e-7, "deviation of what it is given")

    def sequence_of_a_part(self):
        """A part has its own times, draws the weights of the whole, and has its bits after the start-up."""
        random.seed(5)
        rows = [f"{i / 100},{random.gauss(0.0, 1e-4):.9g}\n" for i in range(6000)]
        whole, cut, out = (self.folder / name for name in ("whole.csv", "cut.csv", "cut_out.csv"))
        whole.write_text("time_s,rate_radps\n" + "".join(rows))
        cut.write_text("time_s,rate_radps\n" + "".join(rows[2000:]))
        settings = ["--plain", "--process-noise", "1e-9", "--measurement-noise", "1e-8", "--output", out]
        last = []
        for capture, more in ((whole, []), (cut, ["--sequence", "2000"]), (cut, [])):
            ifog("denoise", capture, *settings, *more)
            last.append(out.read_text().splitlines()[-2000:])
        assert last[0] == last[1]
        assert not any(a == b for a, b in zip(last[0], last[2]))

    def check_denoise(self):
        out = self.folder / "denoised.csv"
        noise = ["--process-noise", 1e-14, "--measurement-noise", N * N * RATE_HZ]  # the temperature varies: no rest to learn from
        ifog("denoise", self.capture, "--filter", "ckf", *noise, "--output", out)
        found = columns(out)
        assert list(found)[:5] == ["time_s", "raw_radps", "compensated_radps", "denoised_radps", "variance_rad2ps2"], list(found)
        assert found["raw_radps"] == columns(self.capture)["rate_radps"]
        second_half = slice(len(found["raw_radps"]) // 2, None)
        raw, denoised = found["raw_radps"][second_half], found["denoised_radps"][second_half]
        assert rms([a - b for a, b in zip(denoised, denoised[1:])]) < 0.5 * rms([a - b for a, b in zip(raw, raw[1:])])
        # No variance before the noise is known from the first seconds; afterwards always.
        variance = found["variance_rad2ps2"]
        known = next(i for i, v in enumerate(variance) if v == v)
        assert known < len(variance) / 4 and min(variance[known:]) > 0
        # The lines of a part are those of the whole.
        part, text = self.folder / "part.csv", out.read_text().splitlines()
        ifog("denoise", self.capture, "--filter", "ckf", *noise, "--output", part, "--from", text[101].split(",")[0], "--to", text[301].split(",")[0])
        assert part.read_text().splitlines() == text[:1] + text[101:301]
        self.sequence_of_a_part()
        lines = self.capture.read_text().splitlines()
        header = next(i for i, line in enumerate(lines) if line.startswith("time_s"))
        three = self.folder / "three.csv"
        three.write_text("time_s,rate_x_radps,rate_y_radps,rate_z_radps\n" + "".join(
            f"{t},{r},{r},{r}\n" for t, r in (line.split(",")[:2] for line in lines[header + 1:header + 1001])))
        ifog("denoise", three, "--output", self.folder / "three_out.csv")
        has(columns(self.folder / "three_out.csv"), *(f"{what}_{axis}_radps" for what in ("raw", "compensated", "denoised") for axis in "xyz"))

    def check_tune(self):
        """`denoise` runs the written model."""
        model = self.folder / "tuned.toml"
        found = self.json("tune", self.folder / "white.csv", "--write-model", model)
        assert found["schema"] == "ifog.tune/1", found["schema"]
        ifog("denoise", self.folder / "white.csv", "--model", model, "--output", self.folder / "tuned.csv")
        # R of white noise is N^2 times the rate.
        import re
        written = float(re.search(r"measurement_noise = (\S+)", model.read_text()).group(1))
        near(written, N * N * RATE_HZ, 4 * N * N * RATE_HZ * math.sqrt(2 / (RATE_HZ * SECONDS)), "measurement_noise")

    def check_compare(self):
        found = self.json("compare", self.folder / "white.csv")
        assert found["schema"] == "ifog.compare/1"
        rules = [row["rule"] for row in found["rows"]]
        assert set(rules) >= {"ckf", "irwe-akfg", "iae", "rae", "mmae", "sage-husa", "vb"}, rules
        for row in found["rows"]:
            has(row, "rule", "settings", "rmse_radps", "std_radps", "adev_radps")
            has(row["adev_radps"], "0.1", "1", "10", "100")
            assert row["rmse_radps"] is None, "no reference was given"
        # The verdict agrees with the table; the picture shows the differences of the others.
        best = min(found["rows"], key=lambda row: row["adev_radps"]["1"])
        verdict, = found["verdict"]
        assert verdict["figure"] == "adev_radps 1" and verdict["best"] == best["rule"] and verdict["best_radps"] == best["adev_radps"]["1"], verdict
        for row in found["rows"]:
            near(row["above_best"], row["adev_radps"]["1"] / best["adev_radps"]["1"] - 1, 1e-9, "above_best of " + row["rule"])
        picture = self.folder / "compare.svg"
        said = ifog("compare", self.folder / "white.csv", "--plot", picture)
        assert verdict["text"] in said and verdict["text"] in picture.read_text(), said
        assert all(f">{row['rule']}</text>" in picture.read_text() for row in found["rows"]), "a curve for each rule"

    def check_diagnose_and_correct(self):
        """The effect is found, written, and removed from the capture by `denoise --model`, causally."""
        model, report = self.folder / "model.toml", self.folder / "report.html"
        found = self.json("diagnose", self.capture, "--quiet", "--write-model", model, "--report", report)
        has(found, "schema", "samples", "sample_rate_hz", "noise", "effects", "before", "after", "indistinguishable", "unexplained")
        assert found["schema"] == "ifog.diagnosis/1" and found["samples"] == RATE_HZ * SECONDS
        assert [(e["form"], e["channel"]) for e in found["effects"]] == [("linear", "temperature_degC")], found["effects"]
        effect = found["effects"][0]
        has(effect, "form", "channel", "meaning", "parameters", "p_value", "variance_explained")
        coefficient = effect["parameters"]["coefficient"]
        near(coefficient["value"], PER_DEGREE, 4 * coefficient["std_error"], "coefficient")
        assert sorted(found["before"]) == sorted(found["after"])
        has(found["unexplained"], "fraction", "kind", "hint")
        ifog("denoise", self.capture, "--model", model, "--output", self.folder / "corrected.csv")
        corrected = columns(self.folder / "corrected.csv")["compensated_radps"]
        mean = sum(corrected) / len(corrected)
        near(rms([v - mean for v in corrected]), N * math.sqrt(RATE_HZ), 0.05 * N * math.sqrt(RATE_HZ), "RMS of the corrected rate")
        # With that model nothing else is found.
        again = self.json("diagnose", self.capture, "--quiet", "--model", model)
        assert again["effects"] == [], again["effects"]

    def check_a_column_that_reads_as_a_difference(self):
        """A model names a difference of two columns "A - B": a column with such a name is dropped with a message, and the written
        model has a difference."""
        odd, model = self.folder / "odd.csv", self.folder / "odd.toml"
        odd.write_text(self.capture.read_text().replace("temperature_degC", "inlet - outlet_degC", 1))
        said = ifog("diagnose", odd, "--write-model", model)
        assert "'inlet - outlet_degC' was dropped" in said, said
        ifog("denoise", odd, "--model", model, "--output", self.folder / "odd_out.csv")
        found = ifog("diagnose", odd, "--column", "rate_radps=rate_radps:rad/s", "--column", "temperature_degC=inlet - outlet_degC")
        assert "linear of temperature_degC" in found, found
        one = self.folder / "one.csv"
        one.write_text("time_s,rate_radps\n0,1e-5\n")
        for captures in ([one], [self.capture, one]):
            complaint = ran("diagnose", *captures).stderr.strip()
            assert complaint == f"ifog: {one}: 1 samples, expected two at least", complaint

    def check_diagnose_reads_frames(self):
        """The same result from a candump log through the driver as from the CSV, if the frames have no channels: no findings."""
        options = ["--dbc", SOURCE / "drivers/dbc/examples/ifogd_gyro.dbc", "--option", "signal=Rate_x", "--option", "counter=Counter",
                   "--option", f"rate_hz={RATE_HZ}"]
        ifog("simulate", self.folder / "white.toml", "--output", self.folder / "white.log", *options)
        found = self.json("diagnose", self.folder / "white.log", "--quiet", *options)
        assert found["samples"] == RATE_HZ * SECONDS and found["effects"] == []

    def check_bad_input(self):
        cases = {
            "word.csv": ("time_s,rate_radps\n0,1e-6\n0.01,abc\n", [":3:", "rate_radps", "'abc'", "expected a number"]),
            "backwards.csv": ("time_s,rate_radps\n0,1e-6\n0.01,2e-6\n0.005,1e-6\n", [":3:", "time_s", "0.01 s", "expected less than in the next row"]),
            "no_rate.csv": ("time_s,foo_V\n0,1\n0.1,1\n0.2,1\n", ["no rate column", "expected"]),
            "cut.csv": ("time_s,rate_radps\n0,1e-6\n0.01\n", [":3:", "1 cells, expected 2"]),
            "empty.csv": ("", ["no header line"]),
        }
        for name, (text, says) in cases.items():
            path = self.folder / name
            path.write_text(text)
            for command in ("allan", "compare", "tune", "diagnose"):
                refused(1, command, path, says=[str(path), *says])
            out = self.folder / "never.csv"
            refused(1, "denoise", path, "--output", out, says=[str(path), *says])
            assert not out.exists(), "a file was left behind"
        absent = self.folder / "absent.csv"
        nearly = self.folder / "nearly.csv"
        nearly.write_text("time_s,gyro_x\n0,1\n1,2\n2,3\n")
        for command in ("allan", "compare", "tune", "diagnose"):
            refused(1, command, absent, says=[str(absent)])
            refused(1, command, nearly, says=["nearly.csv:1: the unit of the rate is not named", "--column rate_x_radps=gyro_x:rad/s", "deg/s"])
        refused(1, "diagnose", self.capture, "--model", absent, says=[str(absent)])
        refused(1, "allan", self.capture, "--axis", "w", says=[str(self.capture), "--axis is 'w'", "expected none, the capture has one axis"])
        bad = self.folder / "bad.toml"
        bad.write_text(SCENARIO.replace("duration_s", "durations_s"))
        refused(1, "simulate", bad, "--output", self.folder / "never.csv", says=["bad.toml:", "durations_s is unknown, did you mean 'duration_s'?"])

    def check_usage(self):
        refused(2, "allan", says=["capture"])
        refused(2, "allan", self.capture, "--nonsense", says=["--nonsense"])
        refused(2, "nonsense", says=["unknown command 'nonsense'", "diagnose"])
        refused(2, "dignose", self.capture, says=["did you mean 'diagnose'?"])
        # The parser only reports that --output is missing.
        refused(2, "denoise", self.capture, "--outptu=a.csv", says=["unknown option '--outptu'", "'--output'"])
        refused(2, says=["expected one of", "allan"])
        refused(2, "allan", self.capture, "--estimator", "hadamar", says=["overlapping, modified, hadamard; did you mean 'hadamard'?"])
        refused(2, "denoise", self.capture, "--filter", "irwe-akgf", says=["ckf", "did you mean 'irwe-akfg'?"])
        refused(2, "denoise", self.capture, "--state", "randomwalk", says=["or a sum of them", "did you mean 'random-walk'?"])
        refused(2, "denoise", self.capture, "--weights", "unifrom", says=["did you mean 'uniform'?"])
        refused(1, "convert", self.capture, self.folder / "never.kvh", "--driver", "kvh1750", "--option", "output=dleta", says=["rate, delta; did you mean 'delta'?"])
        refused(1, "drivers", "kvh175", says=["did you mean 'kvh1750'?", "dsp3000"])
        refused(1, "convert", self.capture, self.folder / "never.kvh", "--driver", "kvh1750", "--option", "rate_hx=200", says=["did you mean 'rate_hz'?"])
        version = ran("--version").stdout.splitlines()
        assert re.fullmatch(r"ifog \d+\.\d+\.\d+ \(driver interface \d+\)", version[0]), version
        assert version[1].startswith("model files of version") and "flight recordings of version" in version[1] and "built by" in version[2], version
        assert all(words[0].isupper() for words in re.findall(r"^  \w+ {2,}(\S.*)$", ran("--help").stdout.split("Subcommands:")[1], re.M))
        refused(2, "diagnose", self.capture, "--significance", "2", says=["--significance"])
        assert ran("--help").returncode == 0


def main_of(kind):
    """Runs every check of the class and prints one line each."""
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        checks = kind(pathlib.Path(folder))
        for name in [name for name in vars(kind) if name.startswith("check_")]:
            try:
                getattr(checks, name)()
                print(f"ok       {name[6:].replace('_', ' ')}", flush=True)
            except (AssertionError, LookupError, ValueError) as error:
                failed += 1
                print(f"FAILED   {name[6:].replace('_', ' ')}: {error}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main_of(Checks))

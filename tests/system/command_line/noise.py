#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Statements about a sensor's noise: equal in every command, for the parts at rest, up to the available τ.

usage: noise.py PATH_OF_IFOG SOURCE_DIR
"""
import json
import math
import random
import re
import sys

import schema
from run import RATE_HZ, SECONDS, columns, has, ifog, main_of, near, ran, refused

N, K = 2.5e-7, 4e-8
SCENARIO = f"""
seed = 5
sample_rate_hz = {RATE_HZ}
duration_s = {SECONDS}
bias_radps = 5e-5
[noise]
N = {N}
K = {K}
"""


class Noise:
    def __init__(self, folder):
        self.folder = folder
        (folder / "walk.toml").write_text(SCENARIO)
        self.capture = folder / "walk.csv"
        ifog("simulate", folder / "walk.toml", "--output", self.capture)

    def json(self, command, *arguments):
        path = self.folder / f"{command}.json"
        said = ifog(command, *arguments, "--json", path)
        assert "nan" not in said.split(), said
        document = json.loads(path.read_text())
        schema.check(document)
        return document

    def turned(self, name, first_s, last_s):
        """The same with a turn of 0.5 rad/s, eight seconds on and four off."""
        rate = columns(self.capture)["rate_radps"]
        lines = [f"{i / RATE_HZ},{r + (0.5 if first_s <= i / RATE_HZ < last_s and i / RATE_HZ % 12 < 8 else 0.0)}"
                 for i, r in enumerate(rate)]
        path = self.folder / name
        path.write_text("time_s,rate_radps\n" + "\n".join(lines) + "\n")
        return path

    def check_what_is_no_noise_is_said_by_every_command(self):
        """Noise that is held for three samples is no sum of the terms, as the tremor of a hand is none. At 5 Hz there is no deviation
        at 0.1 s; of 900 samples no noise is learned, and nothing is filtered."""
        dice, rows = random.Random(3), ["time_s,rate_radps"]
        held = 0.0
        for i in range(6000):
            held = dice.gauss(0, 1e-3) if i % 3 == 0 else held
            rows.append(f"{i / 5},{held + dice.gauss(0, 2e-4):.7f}")
        path, short, picture = (self.folder / name for name in ("held.csv", "short.csv", "short.svg"))
        path.write_text("\n".join(rows) + "\n")
        allan = self.json("allan", path)["axes"][0]["coefficients"]["N"]["std_error"]
        tuned = self.json("tune", path, "--state", "random-walk")
        near(tuned["noise"][0]["coefficients"]["N"]["std_error"], allan, 1e-6 * allan, "bar of N")
        said = ran("tune", path, "--state", "random-walk").stdout
        assert "cannot explain these bands" in said and "takes those bands for noise, too" in said, said
        assert "0.1" not in tuned["models"][0]["held_out"][0]["before"]["adev_radps"], tuned["models"]
        short.write_text("\n".join(rows[:901]) + "\n")
        said = ran("denoise", short, "--output", self.folder / "short.out.csv", "--plot", picture)
        assert "4096 samples at rest are needed" in said.stderr and "Rate, not denoised" in picture.read_text(), said.stderr

    def check_what_was_not_filtered_is_not_said_to_be(self):
        """As many samples as the start-up needs: the noise is known only after the last one."""
        chance = random.Random(5)
        for name, rows, rate_hz, filtered in (("second", 4000, 20000, False), ("short", 350, 100, False), ("long", 6000, 100, True)):
            path, out = self.folder / f"{name}.csv", self.folder / "unfiltered.csv"
            path.write_text("time_s,rate_radps\n" + "".join(f"{i / rate_hz!r},{chance.gauss(0, 1e-5)!r}\n" for i in range(rows)))
            result = ran("denoise", path, "--output", out)
            said, found = result.stdout + result.stderr, columns(out)
            assert result.returncode == 0 and ("from the first seconds" in said) == filtered, said
            assert filtered or found["denoised_radps"] == found["raw_radps"], "filtered after all"
            assert filtered or all(part in said for part in ("not run", "4096 samples", "--model")), said

    def check_hourly_rates_are_asked_about(self):
        """10.3 °/h of Earth's rate in a column of rad/s is interpreted correctly."""
        hourly = self.folder / "hourly.csv"
        hourly.write_text("time_s,rate_radps\n" + "".join(f"{i / 100},{10.3 + 0.1 * math.sin(7919 * i)}\n" for i in range(3000)))
        asked = "more than the bias of any gyro: is it at rest, and is the unit right (deg/h by --column)?"
        for command in (["allan"], ["tune"], ["diagnose", "--quiet"]):
            def said(*words):
                done = ran(*command, *words)
                return done.stdout + done.stderr
            assert asked in said(hourly) or command[-1] == "--quiet" and asked in said(hourly, "--json", "-"), f"{command}: {said(hourly)}"
            assert asked not in said(hourly, "--column", "rate_radps=rate_radps:deg/h") + said(self.capture)

    def check_a_figure_that_grows_stands_in_the_table(self):
        """Slow noise that opposes an effect in the fitted part; the figures of the held-out part are used."""
        path = self.folder / "slow.csv"
        for seed in (7, 9, 15, 36):
            throw, walk, rows = random.Random(seed), 0.0, []
            for i in range(20000):
                t, walk = i / 10, walk + throw.gauss(0, 6e-8)
                channel = 25 + 5 * math.sin(2 * math.pi * t / 37) + math.sin(2 * math.pi * t / 900)
                rows.append(f"{t:.1f},{1e-6 * (channel - 25) + walk * 8 + throw.gauss(0, 1e-6):.9e},{channel:.5f}\n")
            path.write_text("time_s,rate_radps,temperature_degC\n" + "".join(rows))
            found = self.json("diagnose", path, "--quiet", "--fit-to", "0.5")
            assert found["effects"], "there is a model to be judged"
            if found["after"]["rms_100s_radps"] < found["before"]["rms_100s_radps"]:
                assert not any("100 s means grow" in remark for remark in found["remarks"]), found["remarks"]

    def check_every_command_says_the_same(self):
        allan = self.json("allan", self.capture)["axes"][0]["coefficients"]
        tune = self.json("tune", self.capture)["noise"][0]["coefficients"]
        noise = self.json("diagnose", self.capture)["noise"]
        for letter, key, truth in (("N", "N_radps_rthz", N), ("K", "K_radps2_rthz", K)):
            near(allan[letter]["value"], truth, 4 * allan[letter]["std_error"], letter)
            assert tune[letter] == allan[letter], f"tune {tune[letter]}, allan {allan[letter]}"
            near(noise[key], allan[letter]["value"], allan[letter]["std_error"], f"{letter} of diagnose")
            has(noise["std_error"], key)
        assert not allan["B"]["present"] and noise.get("B_radps") is None

    def check_a_glitch_is_said_and_left_out(self):
        """One sample of 1 rad/s, an impossible turn: the figures are those without it."""
        lines = self.capture.read_text().splitlines()
        row = next(i for i, line in enumerate(lines) if line.startswith("100,") or line.startswith("100.0"))
        lines[row] = lines[row].split(",")[0] + ",1.0"
        glitch = self.folder / "glitch.csv"
        glitch.write_text("\n".join(lines) + "\n")
        for command in ("allan", "tune"):
            for capture, said in ((glitch, True), (self.capture, False)):
                result = ran(command, capture)
                assert result.returncode == 0, result.stderr
                assert ("leaps away and back" in result.stdout + result.stderr) == said, f"{command} {capture}: {result.stdout}{result.stderr}"
        with_it, without = (self.json("allan", path)["axes"][0]["coefficients"]["N"]["value"] for path in (glitch, self.capture))
        near(with_it, without, 0.01 * without, "N beside a glitch")
        with_it, without = ({m["state"]: m["log_likelihood"] for m in self.json("tune", path)["models"]} for path in (glitch, self.capture))
        assert max(abs(with_it[state] - without[state]) for state in without) < 5.0, f"{with_it} beside a glitch, {without} without"

    def check_few_missing_samples_do_not_cut_the_curve(self):
        """ssong47, raw_yaw_medium: a logger loses one row a minute. The curve is that of the whole record, by definition. Of a dither
        of 1000 times the noise no sample is made up."""
        time, rate = (columns(self.capture)[name] for name in ("time_s", "rate_radps"))
        lost = {*range(700, len(rate), 1100), 9001, 9020, 9021}
        for name, dither in (("lost", 0.0), ("dither", 1e3 * N * math.sqrt(RATE_HZ))):
            path = self.folder / f"{name}.csv"
            rows = (f"{t!r},{r + dither * math.sin(1.3 * i)!r}\n" for i, (t, r) in enumerate(zip(time, rate)) if i not in lost)
            path.write_text("time_s,rate_radps\n" + "".join(rows))
            assert (f"across {len(lost)} missing samples" in ifog("allan", path)) == (dither == 0), name
        angle = [0.0]
        for r in rate:
            angle.append(angle[-1] + r)
        found = self.json("allan", self.folder / "lost.csv")["axes"][0]
        assert found["tau_s"][-1] > 0.2 * SECONDS and found["samples"] == len(rate) - len(lost), found["tau_s"][-1]
        for tau, deviation in zip(found["tau_s"], found["adev_radps"]):
            m = round(tau * RATE_HZ)
            squares = [(angle[i + 2 * m] - 2 * angle[i + m] + angle[i]) ** 2 for i in range(len(rate) - 2 * m + 1)]
            near(deviation, math.sqrt(sum(squares) / len(squares) / 2) / m, 0.01 * deviation, f"deviation at {tau} s")

    def check_no_average_beyond_the_estimator(self):
        third = SECONDS / 3
        refused(1, "allan", self.capture, "--estimator", "hadamard", "--tau", math.ceil(third) + 1,
                says=["Hadamard deviation", f"to {math.floor(third * RATE_HZ) / RATE_HZ:.6g} s"])
        refused(1, "allan", self.capture, "--tau", SECONDS / 2 + 1, says=["overlapping deviation", f"to {SECONDS // 2} s"])
        for tau in ("1e20", "1e-20", "1e308"):  # the number of samples exceeds the range of the number type
            refused(1, "allan", self.capture, "--tau", tau, says=["outside what the overlapping deviation", f"to {SECONDS // 2} s"])
        assert self.json("allan", self.capture, "--tau", f"1,{SECONDS},2")["axes"][0]["tau_s"] == [1, 2]
        for estimator in ("overlapping", "modified", "hadamard"):
            found = self.json("allan", self.capture, "--estimator", estimator, "--tau", math.floor(third))["axes"][0]
            assert 0 < found["lower_radps"][0] < found["adev_radps"][0] < found["upper_radps"][0], found

    def check_long_averages(self):
        found = self.json("allan", self.capture, "--long")["axes"][0]["theo1"]
        near(found["tau_s"][-1], 0.75 * SECONDS, 0.02 * SECONDS, "the longest averaging time")
        assert all(low < sigma < high for low, sigma, high in
                   zip(found["lower_radps"], found["adev_radps"], found["upper_radps"])), found

    def check_a_part_of_the_record(self):
        part = ("--from", 100, "--to", 250)
        assert self.json("allan", self.capture, *part)["axes"][0]["samples"] == 150 * RATE_HZ
        assert self.json("tune", self.capture, *part)["samples"] == 150 * RATE_HZ
        found = self.json("diagnose", self.capture, *part)
        assert found.get("samples", found.get("axes", [{}])[0].get("samples")) == 150 * RATE_HZ, list(found)
        for command in ("allan", "tune", "diagnose"):
            refused(1, command, self.capture, "--from", SECONDS + 1, says=["--from", f"{SECONDS - 1 / RATE_HZ:.10g} s"])

    def check_turned_parts_are_left_out(self):
        path = self.turned("turned.csv", 100, 148)
        for command in ("allan", "tune", "diagnose"):
            said = ifog(command, path)
            assert "turned" in said and "only the rest is" in said, f"{command}: {said[:600]}"
        found = self.json("allan", path)["axes"][0]["coefficients"]["N"]
        near(found["value"], N, 4 * found["std_error"], "N beside a turn")

    def check_a_turned_record_is_refused(self):
        path = self.turned("hand.csv", 0, SECONDS)
        for command in ("allan", "tune", "diagnose"):
            refused(1, command, path, says=[str(path), "turned", "mostly at rest"])
        assert self.json("allan", path, "--moving", "keep")["axes"][0]["samples"] == SECONDS * RATE_HZ

    def check_slow_turns_are_said(self):
        """Slower than the limit of a turn: all of it is analysed, with a note."""
        lines = self.capture.read_text().splitlines()
        start = next(i for i, line in enumerate(lines) if line[:1].isdigit())
        for i in range(start + 100 * RATE_HZ, start + 148 * RATE_HZ):
            cells = lines[i].split(",")
            cells[1] = repr(float(cells[1]) + 4.8e-4)
            lines[i] = ",".join(cells)
        path = self.folder / "slow.csv"
        path.write_text("\n".join(lines) + "\n")
        for command in ("allan", "tune"):
            assert "the rate leaps by up to" in ifog(command, path), command
            assert "the rate leaps" not in ifog(command, self.capture), command

    def check_a_table_is_sent_to_diagnose(self):
        path = self.folder / "table.csv"
        dwells = (0.2 * (i % 9 - 4) for i in range(400))
        path.write_text("time_s,rate_radps,reference_rate_radps\n" +
                        "".join(f"{16 * i + 0.5},{1.0005 * rate + 1e-6 * (i * 7919 % 13 - 6)!r},{rate!r}\n" for i, rate in enumerate(dwells)))
        for command in ("allan", "tune"):
            refused(1, command, path, says=["mostly at rest", "ifog diagnose"])
        assert "ifog diagnose" in ifog("allan", path, "--minus-reference")

    def check_a_triad_at_rest_tells_the_earths_rate(self):
        """Mounted anyhow, at latitude 50° north: 15.041 °/h, of which 11.522 °/h are along the specific force."""
        earth, up, north = 7.292115e-5, (0.48, 0.6, 0.64), (0.8, 0.0, -0.6)
        sine, cosine = math.sin(math.radians(50)), math.cos(math.radians(50))
        dice, rows = random.Random(6), ["time_s,rate_x_radps,rate_y_radps,rate_z_radps,accel_x_mps2,accel_y_mps2,accel_z_mps2"]
        for i in range(20_000):
            rates = [earth * (sine * u + cosine * n) + dice.gauss(0, 1e-6) for u, n in zip(up, north)]
            rows.append(",".join(map(repr, [i / 50, *rates, *(9.81 * u + dice.gauss(0, 1e-3) for u in up)])))
        path = self.folder / "triad.csv"
        path.write_text("\n".join(rows) + "\n")
        said = re.search(r"specific force is ([\d.]+) °/h; .* latitude ([\d.]+)°", ifog("diagnose", path))
        near(float(said[1]), 11.522, 0.01, "the vertical rate")
        near(float(said[2]), 50.0, 0.1, "the latitude")

    def check_compare_says_what_moved_and_leaves_it_out_as_allan_does(self):
        """A turn in the middle: its time is printed, and std and deviation are those of allan's rest."""
        path = self.turned("turned.csv", 100, 148)
        found, allan = self.json("compare", path), self.json("allan", path, "--tau", "0.1,1,10")["axes"][0]
        assert "moving in" in found["motion"] and "at rest alone" in found["motion"], found["motion"]
        assert found["samples_at_rest"] == allan["samples"] < found["samples"]
        for tau, value in zip(("0.1", "1", "10"), allan["adev_radps"]):
            assert abs(found["raw"][0]["adev_radps"][tau] / value - 1) < 1e-9, (tau, value, found["raw"][0])
        assert "not judged" not in found["verdict"][0]["text"], found["verdict"]
        turning = self.json("compare", path, "--from", "98", "--to", "150")
        assert "not judged" in turning["verdict"][0]["text"], turning["verdict"]
        still = self.json("compare", path, "--to", "90")
        assert still["motion"] == "" and still["samples"] == still["samples_at_rest"] == 90 * RATE_HZ

    def check_several_captures_in_one_table(self):
        other = self.turned("other.csv", 0, 0)
        said = ifog("allan", self.capture, other, "--plot", self.folder / "both.svg")
        table = said[said.rindex("lowest deviation"):]
        assert "walk.csv" in table and "other.csv" in table, table
        picture = (self.folder / "both.svg").read_text()
        # Assignments of terms are in the legend, not among the curves; for equal curves they appear once.
        assert re.search(r">walk\.csv: [QNBKR] = ", picture), picture[-2000:]


if __name__ == "__main__":
    sys.exit(main_of(Noise))

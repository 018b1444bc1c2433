#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The filter's noise fits its input rate, in either order of `tune` and `diagnose`.

A gyro whose bias follows its temperature, and its twin without that effect, with identical white noise. The tuned twin is the
oracle: the corrected gyro's output may be only little noisier than the twin's.

usage: noise_left.py PATH_OF_IFOG
"""
import csv
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile

RATE_HZ, SECONDS, BIAS, SIGMA, PER_DEGREE = 20, 600, 7e-5, 1e-5, 2e-6
SETTLED_S = 120


def capture(path, seed, effect, warmer):
    noise = random.Random(seed)
    with open(path, "w") as file:
        file.write("time_s,rate_radps,temperature_degC\n")
        for i in range(RATE_HZ * SECONDS):
            t = i / RATE_HZ
            degrees = 25 + warmer + 3 * math.sin(t / 50)
            rate = BIAS + effect * (degrees - 25) + SIGMA * noise.gauss(0, 1)
            file.write(f"{t:.2f},{rate:.9e},{degrees:.4f}\n")


def ifog(*arguments):
    done = subprocess.run([IFOG, *map(str, arguments)], capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, f"{arguments}: {done.stderr}"
    return done.stdout


def settled_error(denoised):
    with open(denoised) as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    errors = [float(row["denoised_radps"]) - BIAS for row in rows if float(row["time_s"]) >= SETTLED_S]
    return math.sqrt(sum(error * error for error in errors) / len(errors))


def told(model, key):
    return float(re.search(rf"^{key} = (\S+)$", model.read_text(), re.M)[1])


def effects_of(model):
    text = model.read_text()
    return text[text.index("[[effect]]"):]


def check(folder):
    capture(folder / "fit.csv", 1, PER_DEGREE, 0)
    capture(folder / "next.csv", 2, PER_DEGREE, 0.5)
    capture(folder / "twin-fit.csv", 1, 0, 0)
    capture(folder / "twin-next.csv", 2, 0, 0)

    def published(name, model):
        ifog("denoise", folder / name, "--model", model, "--output", folder / "out.csv")
        return settled_error(folder / "out.csv")

    walk = ["--state", "random-walk"]
    ifog("tune", folder / "twin-fit.csv", *walk, "--write-model", folder / "twin.toml")
    twin = published("twin-next.csv", folder / "twin.toml")

    # First tuned, on the rate that follows the temperature, then diagnosed.
    ifog("tune", folder / "fit.csv", *walk, "--write-model", folder / "tuned.toml")
    said = ifog("diagnose", folder / "fit.csv", "--model", folder / "tuned.toml", "--write-model", folder / "both.toml")
    assert "fitted to the corrected rate" in said, said
    # First diagnosed, then tuned on the corrected rate.
    ifog("diagnose", folder / "fit.csv", "--write-model", folder / "found.toml")
    ifog("tune", folder / "fit.csv", *walk, "--model", folder / "found.toml", "--write-model", folder / "then.toml")
    assert effects_of(folder / "found.toml") == effects_of(folder / "then.toml"), "tune changed the effects"

    before = told(folder / "tuned.toml", "process_noise")
    for name in ("found.toml", "both.toml", "then.toml"):
        quick = told(folder / name, "process_noise")
        assert quick < before / 30, f"{name}: process noise {quick}, before the effect was known {before}"
        white = told(folder / name, "measurement_noise")
        assert abs(white / SIGMA**2 - 1) < 0.05, f"{name}: measurement noise {white}, truth {SIGMA**2}"
        error = published("next.csv", folder / name)
        print(f"{name}: error {error:.3g} rad/s, the twin's {twin:.3g}")
        assert error < 1.5 * twin, f"{name}: {error} rad/s RMS, the twin without the effect {twin}"

    # A model is unchanged if nothing new is found.
    said = ifog("diagnose", folder / "twin-fit.csv", "--model", folder / "twin.toml", "--write-model", folder / "same.toml")
    assert "fitted to the corrected rate" not in said, said
    assert told(folder / "same.toml", "process_noise") == told(folder / "twin.toml", "process_noise")

    # A missing channel of a file gives one line with both names.
    (folder / "bare.csv").write_text("time_s,rate_radps\n" + "".join(f"{i / 20},{i % 7 * 1e-6}\n" for i in range(400)))
    done = subprocess.run([IFOG, "tune", folder / "bare.csv", "--model", folder / "found.toml"], capture_output=True, text=True)
    assert done.returncode == 1 and "found.toml" in done.stderr and "temperature_degC" in done.stderr, done.stderr


IFOG = sys.argv[1]
with tempfile.TemporaryDirectory() as scratch:
    check(pathlib.Path(scratch))

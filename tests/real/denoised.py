#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Real sensors at rest, denoised with the model of `diagnose` as with that of `tune`, as a user would.

    denoised.py --ifog build/release/tools/ifog/ifog --data ../shared/data [--check]

Error of the denoised rate against the mean of the next 10 s of the corrected one, deg/h, from a fifth of the record on. Exits 1
with --check where either is above 1.1 of the better of the two."""
import argparse
import csv
import math
import subprocess
import sys
import tempfile
from pathlib import Path

NAMES = ("ln100_x_up", "adis16405_imu3_1hz", "adis16405_imu5_1hz", "adis16405_imu1")
AHEAD_S, MOST = 10.0, 1.1


def ifog(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=280)
    if done.returncode != 0:
        sys.exit(f"{arguments}: {done.stderr}")


def errors(path):
    with open(path, newline="") as file:
        rows = [[float(cell or "nan") for cell in row] for row in csv.reader(file) if row[0][0] not in "#t"]
        file.seek(0)
        names = next(line for line in file if not line.startswith("#")).strip().split(",")
    columns = dict(zip(names, zip(*rows)))
    times = columns["time_s"]
    ahead = max(1, round(AHEAD_S * (len(times) - 1) / (times[-1] - times[0])))
    for name in names:
        if not name.startswith("denoised_"):
            continue
        sums = [0.0]
        for rate in columns[name.replace("denoised", "compensated")]:
            sums.append(sums[-1] + (0.0 if math.isnan(rate) else rate))
        judged = range(len(times) // 5, len(times) - ahead)
        square = sum((columns[name][i] - (sums[i + 1 + ahead] - sums[i + 1]) / ahead) ** 2 for i in judged)
        yield name[len("denoised_"):-len("_radps")], math.degrees(math.sqrt(square / len(judged))) * 3600


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ifog", required=True)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    if not options.data.exists():
        print(f"skipped: {options.data} is not there")
        return 77
    missed = 0
    print("| capture | axis | diagnose | tune | |\n|---|---|---|---|---|")
    for name in NAMES:
        capture, found = options.data / f"{name}.csv.gz", {}
        with tempfile.TemporaryDirectory() as work:
            model, out = Path(work) / "model.toml", Path(work) / "out.csv"
            for way in ("diagnose", "tune"):
                ifog(options.ifog, way, capture, "--write-model", model)
                ifog(options.ifog, "denoise", capture, "--model", model, "--output", out)
                found[way] = dict(errors(out))
        for axis, diagnosed in found["diagnose"].items():
            tuned = found["tune"][axis]
            fine = max(diagnosed, tuned) <= MOST * min(diagnosed, tuned)
            missed += not fine
            print(f"| {name} | {axis} | {diagnosed:.4g} | {tuned:.4g} | {'' if fine else 'missed'} |", flush=True)
    return 1 if options.check and missed else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""One folder of recordings from two runs of the daemon with different driver options, as the device was changed: each run is
filtered from its beginning with its own options. The device sent the same rates both times, so both halves are equal.

usage: runs.py BUILD

In its own network namespace. One line per check, `ok` or `FAILED`. Exit 77, with the reason, if something required is missing.
"""
import csv
import os
import random
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import private_network  # noqa: E402

ROWS, RATE_HZ = 3000, 100
CONFIG = """[daemon]
plugin_folder = "{plugins}"
lock_memory = false
lcm_url = "udpm://239.255.76.67:7667?ttl=0"
[[sensor]]
name = "nose"
driver = "kvh1750"
[sensor.transport]
type = "file"
path = "{unit}.kvh"
[sensor.options]
rate_hz = {rate}
angle_unit = "{unit}"
[sensor.filter]
process_noise = 1e-13
measurement_noise = 1e-10
[sensor.record]
folder = "record"
"""


def columns(path):
    with open(path) as file:
        rows = [row for row in csv.DictReader(line for line in file if not line.startswith("#"))]
    return {name: [float(row[name]) for row in rows] for name in ("time_s", "raw_x_radps", "denoised_x_radps")}


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for tool in ("ip", "unshare"):
        if shutil.which(tool) is None:
            print(f"SKIPPED: {tool} is missing; tools/install-packages test brings it")
            return 77
    private_network.enter()
    build = os.path.abspath(sys.argv[1])
    ifog, ifogd = os.path.join(build, "tools/ifog/ifog"), os.path.join(build, "daemon/ifogd")
    failed = False

    def check(good, what):
        nonlocal failed
        failed = failed or not good
        print(f"{'ok     ' if good else 'FAILED '} {what}", flush=True)

    def run(*arguments):
        done = subprocess.run(arguments, capture_output=True, text=True, timeout=100, check=False)
        if done.returncode != 0:
            sys.exit(f"{' '.join(arguments)}: exit {done.returncode}: {done.stderr.strip()}")
        return done.stdout + done.stderr

    draw = random.Random(7)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        with open("sent.csv", "w") as file:
            file.write("time_s,rate_x_radps\n" + "".join(f"{i / RATE_HZ},{draw.gauss(1e-3, 1e-5)}\n" for i in range(ROWS)))
        for unit in ("radians", "degrees"):
            run(ifog, "convert", "sent.csv", f"{unit}.kvh", "--driver", "kvh1750", "--option", f"rate_hz={RATE_HZ}", "--option", f"angle_unit={unit}")
            with open(f"{unit}.toml", "w") as file:
                file.write(CONFIG.format(plugins=os.path.join(build, "plugins"), unit=unit, rate=RATE_HZ))
            run(ifogd, "--config", f"{unit}.toml")
        said = run(ifog, "denoise", "record/nose", "--output", "as_it_was.csv")
        check("2 run(s) of the daemon" in said and ": each as it was; at the end" in said, "two runs, each as it was")
        found = columns("as_it_was.csv")
        check(len(found["time_s"]) == 2 * ROWS, "all of both")
        difference = max(abs(a - b) for name in ("raw_x_radps", "denoised_x_radps") for a, b in zip(found[name][:ROWS], found[name][ROWS:]))
        check(difference < 1e-9, f"each by its own options: the second differs from the first by {difference:.2g} rad/s, as float32 rounds")
        run(ifog, "convert", "record/nose", "rates.csv")
        with open("rates.csv") as file:
            rates = [float(row["rate_x_radps"]) for row in csv.DictReader(line for line in file if not line.startswith("#"))]
        check(max(abs(a - b) for a, b in zip(rates[:ROWS], rates[ROWS:])) < 1e-9, "also for commands that want columns")
        said = run(ifog, "denoise", "record/nose", "--window", "40", "--output", "other.csv")
        check("each as it was, but for what the command line says" in said, "what is said on the command line is not said to have been so")
        # As configured, both in radians. The second run restarts, so its first value differs.
        said = run(ifog, "denoise", "record/nose", "--config", "radians.toml", "--output", "configured.csv")
        found = columns("configured.csv")
        check("each run from its beginning, as configured" in said, "with a configuration each run begins anew")
        first, second = found["denoised_x_radps"][0], found["denoised_x_radps"][ROWS]
        check(abs(first - found["raw_x_radps"][0]) < 1e-12 and abs(second - found["raw_x_radps"][ROWS]) < 1e-12, "with the first sample that it has")
    return failed


if __name__ == "__main__":
    sys.exit(main())

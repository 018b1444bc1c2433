#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Progress and time left on a terminal: pyte emulates the screen that `ifog` draws on standard error. Without a terminal nothing is
drawn.

usage: progress.py PATH_OF_IFOG Exit 77 without pyte.
"""
import os
import pathlib
import pty
import re
import select
import subprocess
import sys
import tempfile
import time

try:
    import pyte
except ImportError:
    print("skipped: no pyte (apt install python3-pyte)")
    sys.exit(77)

IFOG = sys.argv[1]
SCENARIO = "seed = 3\nsample_rate_hz = 1000\nduration_s = {}\naxes = [\"x\", \"y\", \"z\"]\n[noise]\nN = 2.5e-7\nB = 1e-7\n"
BAR = re.compile(r"^(?P<what>.+?) \[(?P<bar>[#.]{30})\] (?P<percent>\d+) %, (?P<left>\d+ (s|min|h)( \d+ min)? left|\d+ s so far)$")


def at_a_terminal(*arguments):
    """Exit status, every line on the screen while the command ran, and the final screen."""
    screen = pyte.Screen(100, 24)
    stream = pyte.ByteStream(screen)
    main, terminal = pty.openpty()
    process = subprocess.Popen([IFOG, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=terminal)
    os.close(terminal)
    seen, deadline = [], time.monotonic() + 250
    while time.monotonic() < deadline:
        if not select.select([main], [], [], 0.05)[0]:
            continue
        try:
            data = os.read(main, 65536)
        except OSError:  # the other end is closed
            break
        for part in data.split(b"\r"):
            stream.feed(b"\r" + part)
            seen += [line.rstrip() for line in screen.display if line.strip() and line.rstrip() not in seen]
    os.close(main)
    return process.wait(timeout=10), seen, [line.rstrip() for line in screen.display if line.strip()]


def main():
    failed = 0

    def check(what, good, why=""):
        nonlocal failed
        print(f"ok       {what}" if good else f"FAILED   {what}: {why}", flush=True)
        failed += not good

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "long.toml").write_text(SCENARIO.format(300))
        runs = [("simulating", ["simulate", folder / "long.toml", "--output", folder / "long.csv.gz"]),
                ("writing long.csv.gz", None),
                ("reading long.csv.gz", ["denoise", folder / "long.csv.gz", "--output", folder / "denoised.csv"]),
                ("denoising", None),
                ("writing long.h5", ["convert", folder / "long.csv.gz", folder / "long.h5"]),
                ("comparing", ["compare", folder / "long.h5"]),
                ("fitting state models", ["tune", folder / "long.h5"])]
        seen, everything = [], []
        for what, command in runs:
            if command is not None:
                status, seen, at_end = at_a_terminal(*command)
                everything += seen
                check(f"{command[0]} ends well at a terminal", status == 0, at_end)
                check(f"{command[0]} leaves no bar", not any("[#" in line or "so far" in line for line in at_end), at_end)
            lines = [line for line in seen if line.startswith(what)]
            # A fast machine shows nothing; what is shown must be right.
            wrong = [line for line in lines if not BAR.match(line) and not re.match(r"[^\[]+, \d+ s so far$", line)]
            check(f"{what}: {len(lines)} lines", not wrong, wrong[:3])
            counted = [int(BAR.match(line)["percent"]) for line in lines if BAR.match(line) and BAR.match(line)["what"] == what]
            check(f"{what} goes on", counted == sorted(counted), counted)
            for line in filter(BAR.match, lines):
                bar, percent = BAR.match(line)["bar"], int(BAR.match(line)["percent"])
                if abs(bar.count("#") / 30 - percent / 100) > 0.05:
                    check(f"{what}: the bar is as long as it says", False, line)
        all_left = [line for line in everything if " left" in line]
        check("some command said what time is left", bool(all_left), everything[-3:])
        quiet = subprocess.run([IFOG, "convert", folder / "long.h5", folder / "again.h5"], capture_output=True, check=False, timeout=250)
        check("nothing of it goes into a pipe", quiet.returncode == 0 and b"\x1b" not in quiet.stderr and b"%" not in quiet.stderr, quiet.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

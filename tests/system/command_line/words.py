#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a person is told, and does with it: names of files that say another format than what is written, commands printed to be
copied, files that lack what was asked for, and what is counted.

usage: words.py PATH_OF_IFOG SOURCE_DIR
"""
import random
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

    def check_a_name_says_what_is_written(self):
        """Of a format that nobody writes, or that this command does not, nothing is."""
        folder = self.folder / "endings"
        folder.mkdir()
        scenario, kvh = SOURCE / "tools/simulate/scenarios/rest.toml", ["--driver", "kvh1750"]
        for ending in (".mat", ".npz", ".CSV", ".ifr", ".lcm"):
            to = folder / ("out" + ending)
            for command in (["denoise", self.one, "--output", to], ["convert", self.one, to], ["convert", self.one, to, *kvh],
                            ["simulate", scenario, "--output", to], ["simulate", scenario, "--output", to, *kvh]):
                refused(2, *command, says=[f"'{to}', expected a name ending in .csv, .csv.gz or .h5"])
        for ending in (".kvh", ".log", ".txt"):
            refused(2, "denoise", self.one, "--output", folder / ("out" + ending), says=["expected a name ending in .csv, .csv.gz or .h5\n"])
        refused(2, "simulate", scenario, "--output", folder / "out.csv", "--truth", folder / "truth.mat", says=["--truth", ".json, .csv"])
        assert not list(folder.iterdir()), list(folder.iterdir())
        for name in ("out.csv", "out.csv.gz", "out.h5", "out"):
            ifog("denoise", self.one, "--output", folder / name)
            assert (folder / name).stat().st_size > 0


if __name__ == "__main__":
    sys.exit(main_of(Checks))

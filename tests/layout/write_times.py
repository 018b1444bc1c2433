#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the durations of the usual run into the table at the end of tests/README.md; called by the run itself.

usage: tests/layout/write_times.py STAGE=SECONDS...
"""
import datetime
import os
import pathlib
import re
import subprocess
import sys

README = pathlib.Path(__file__).resolve().parents[1] / "README.md"


def main():
    if len(sys.argv) < 2 or any(not re.fullmatch(r"[a-z ]+=\d+", word) for word in sys.argv[1:]):
        sys.exit(__doc__)
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=README.parent, capture_output=True, text=True, check=False).stdout.strip()
    told = f"`./tools/test` of {datetime.date.today():%d %B %Y}, {commit or 'no git checkout'}, on {os.cpu_count()} processors:"
    rows = [f"| {stage} | {seconds} |" for stage, seconds in (word.split("=") for word in sys.argv[1:])]
    text = README.read_text()
    head, mark, _ = text.partition("<!-- Written by ./tools/test --into-readme. -->\n")
    if not mark:
        sys.exit(f"{README}: has no line '<!-- Written by ./tools/test --into-readme. -->'")
    README.write_text(head + mark + "\n" + "\n".join([told, "", "| stage | s |", "|---|---|", *rows]) + "\n")


if __name__ == "__main__":
    main()

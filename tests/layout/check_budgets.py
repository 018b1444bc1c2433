#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Limits the number of lines, files and named numeric constants of C++ per folder (tests/layout/budgets.txt). Budgets only decrease:
after making a folder smaller, lower its line.

usage: tests/layout/check_budgets.py one line per violation; exit 1 if there is one tests/layout/check_budgets.py --lower writes
the present values if they are lower, and adds no folder
"""
import pathlib
import re
import subprocess
import sys

TREE = pathlib.Path(__file__).resolve().parents[2]
BUDGETS = TREE / "tests/layout/budgets.txt"
CONSTANT = re.compile(r"\bconstexpr\s+(?:double|float|int|unsigned|auto|std::\w+)\s+k[A-Z]\w*\s*[={]")
COLUMNS = ("lines", "files", "constants")


def sizes(folders):
    """Lines, files and constants of the C++ in each folder and below."""
    listed = subprocess.run(["git", "ls-files", "*.cpp", "*.h"], cwd=TREE, capture_output=True, text=True, check=True).stdout.split()
    found = {folder: [0, 0, 0] for folder in folders}
    for name in listed:
        if not (TREE / name).is_file():
            continue
        text = (TREE / name).read_text()
        size = (text.count("\n"), 1, len(CONSTANT.findall(text)))
        for folder in folders:
            if folder == "." or name.startswith(folder + "/"):
                found[folder] = [a + b for a, b in zip(found[folder], size)]
    return found


def main():
    lines = BUDGETS.read_text().splitlines()
    budgets = {parts[0]: list(map(int, parts[1:])) for line in lines if (parts := line.split()) and not line.startswith("#")}
    there = sizes(budgets)
    if sys.argv[1:] == ["--lower"]:
        budgets = {folder: list(map(min, most, there[folder])) for folder, most in budgets.items()}
        head = [line for line in lines if line.startswith("#")]
        BUDGETS.write_text("\n".join(head + [f"{folder:26}" + "".join(f"{n:8}" for n in most) for folder, most in budgets.items()]) + "\n")
        return 0
    wrong = [f"{folder}: {have} {what}, at most {may}" for folder, most in budgets.items()
             for what, have, may in zip(COLUMNS, there[folder], most) if have > may]
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""One impossible value among thousands, in every column and for every command that reads: each command ends in time, all its numbers
are finite, and the result is that of a missing cell. Oracle: the same capture without the cell. The same for a long line.

usage: huge.py PATH_OF_IFOG SOURCE_DIR
"""
import json
import math
import random
import sys

from run import columns, main_of, ran

ROWS, RATE_HZ = 4000, 50
HUGE = ("1e200", "-1e200", "1e308", "1e30", "9e15", "nan")
INFINITE = ("inf", "-inf", "1e999")
COLUMNS = ("rate_radps", "temperature_degC", "ramp_counts", "something")
WHERE = (0, 7, 1999, ROWS - 1)


def numbers_of(value, path=""):
    """Every number of a document with its path."""
    if isinstance(value, dict):
        return {k: v for key, each in value.items() if key not in ("capture", "captures", "created", "sha256") for k, v in numbers_of(each, f"{path}.{key}").items()}
    if isinstance(value, list):
        return {k: v for i, each in enumerate(value) for k, v in numbers_of(each, f"{path}[{i}]").items()}
    return {path: value} if isinstance(value, float | int) and not isinstance(value, bool) else {}


class Checks:
    def __init__(self, folder):
        self.folder = folder
        dice = random.Random(11)
        self.rows = []
        for i in range(ROWS):
            warm = 25.0 + 3.0 * math.sin(i / 300.0)
            self.rows.append([repr(i / RATE_HZ), repr(1e-5 + 2e-6 * (warm - 25.0) + dice.gauss(0, 3e-6)), repr(warm), str(i * 37 % 4096), repr(dice.gauss(0, 1))])

    def write(self, name, cells):
        path = self.folder / name
        rows = [list(row) for row in self.rows]
        for row, column, text in cells:
            rows[row][1 + COLUMNS.index(column)] = text
        path.write_text("\n".join([",".join(("time_s", *COLUMNS)), *map(",".join, rows)]) + "\n")
        return path

    def answers(self, command, path):
        out = self.folder / "out.json"
        out.unlink(missing_ok=True)
        more = {"denoise": ["--output", self.folder / "d.csv"], "tune": ["--samples", "2000", "--state", "random-walk"]}.get(command, [])
        result = ran(command, path, *more, "--json", out)  # within its time
        assert result.returncode == 0, f"{command} {path.name}: exit {result.returncode}: {result.stderr}"
        text = out.read_text()
        found = numbers_of(json.loads(text))
        assert found and all(math.isfinite(each) for each in found.values()) and "NaN" not in text and "Infinity" not in text, f"{command} {path.name}"
        if command == "denoise":
            for name, values in columns(self.folder / "d.csv").items():
                assert not [each for each in values if abs(each) > 1e6], f"{path.name}: {name}"
        return found

    def same(self, command, column, text, found, expected):
        assert found.keys() == expected.keys(), f"{command}, {text} in {column}: other keys than with the cell empty"
        for path, value in expected.items():
            assert math.isclose(found[path], value, rel_tol=1e-9, abs_tol=1e-300), f"{command}, {text} in {column}: {path} is {found[path]}, expected {value}"

    def check_a_long_line_costs_no_more_than_its_length(self):
        """As of XML or base64 in one line, above the header, among the rows, and longer than a line may be."""
        path = self.folder / "line.csv"
        for mark in ("-", '"', "{", "2026-", "-.", ' "'):
            for size in (900_000, 1_100_000):
                line = mark * (size // len(mark))
                path.write_text("\n".join(["# " + line, "time_s,rate_radps", "0,0", line, *map("{0},0".format, range(1, 200))]) + "\n")
                read = ran("convert", path, self.folder / "line_read.csv")
                assert read.returncode == (0 if size < 2**20 else 1), (mark, size, read.stderr[:200])

    def check_one_cell(self):
        """A huge value has the effect of an empty cell."""
        empty = {column: self.write(f"{column}_empty.csv", [(1999, column, "")]) for column in COLUMNS}
        for column in COLUMNS:
            for command in ("allan", "tune", "compare", "diagnose", "denoise"):
                expected = self.answers(command, empty[column])
                for text in HUGE + INFINITE if command == "diagnose" and column == "rate_radps" else HUGE[:1] + INFINITE[:1]:
                    self.same(command, column, text, self.answers(command, self.write("huge.csv", [(1999, column, text)])), expected)

    def check_the_first_the_last_and_while_the_noise_is_learned(self):
        for row in WHERE:
            for command in ("diagnose", "denoise", "tune"):
                self.answers(command, self.write("huge.csv", [(row, column, "1e200") for column in COLUMNS]))

    def check_a_column_of_them(self):
        """A rate with more than 1 % of impossible values is rejected; a channel without valid values is dropped."""
        for column in COLUMNS:
            path = self.write("column.csv", [(row, column, "1e200") for row in range(0, ROWS, 2)])
            for command in ("diagnose", "denoise"):
                result = ran(command, path, *(["--output", self.folder / "d.csv"] if command == "denoise" else []))
                expected = 1 if column == "rate_radps" else 0
                assert result.returncode == expected, f"{command}, {column}: exit {result.returncode}: {result.stderr}"
                assert expected == 0 or len(result.stderr.strip().splitlines()) == 1, result.stderr


if __name__ == "__main__":
    sys.exit(main_of(Checks))

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every --json against its schema, with captures that produce all parts: several axes, gaps, a reference, a model.

usage: schemas.py PATH_OF_IFOG SOURCE_DIR Exit 77 without python3-jsonschema.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import schema

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import each_check  # noqa: E402

IFOG, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
# Three axes, an effect for each kind of table, a temperature, steps and motion; as short as a diagnosis allows.
SCENARIO = """
seed = 5
sample_rate_hz = 50
duration_s = 240
axes = ["x", "z"]
[noise]
N = 2.5e-7
[[channel]]
name = "temperature_degC"
shape = "cycle"
level = 27.0
amplitude = 3.0
period_s = 100
[[effect]]
form = "linear"
channel = "temperature_degC"
coefficient = 4e-6
reference = 25.0
axis = "x"
"""


def ran(*arguments):
    result = subprocess.run([IFOG, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=200, check=False)
    assert result.returncode == 0, f"ifog {' '.join(map(str, arguments))}: exit {result.returncode}: {result.stderr.strip()}"
    return result.stdout


class Checks:
    def __init__(self, folder):
        self.folder = folder
        (folder / "three.toml").write_text(SCENARIO)
        self.capture = folder / "three.csv"
        self.truth = folder / "truth.json"
        ran("simulate", folder / "three.toml", "--output", self.capture, "--truth", self.truth)

    def held(self, command, *arguments):
        path = self.folder / f"{command}.json"
        ran(command, *arguments, "--json", path)
        document = json.loads(path.read_text())
        schema.check(document)
        return document

    def check_allan(self):
        assert len(self.held("allan", self.capture)["axes"]) == 2
        assert "theo1" in self.held("allan", self.capture, "--long", "--axis", "x")["axes"][0]

    def check_tune(self):
        self.held("tune", self.capture, "--samples", "3000", "--state", "random-walk")

    def check_compare(self):
        rows = self.held("compare", self.capture)["rows"]
        assert {row["axis"] for row in rows} == {"x", "z"}
        reference = self.folder / "reference.csv"
        reference.write_text("".join(line if line.startswith("#") else line.rstrip("\n") + (",reference_rate_x_radps\n" if "time_s" in line else ",0\n")
                                     for line in self.capture.read_text().splitlines(keepends=True)))
        assert self.held("compare", reference)["rows"][0]["rmse_radps"] is not None

    def check_diagnosis_and_denoise(self):
        model = self.folder / "model.toml"
        found = self.held("diagnose", self.capture, "--quiet", "--write-model", model)
        assert set(found["before"]) == {"x", "z"} and found["effects"], found
        assert self.held("denoise", self.capture, "--model", model, "--output", self.folder / "d.csv")["model"]
        # One axis: the same keys without the axes.
        single = self.folder / "single.csv"
        ran("convert", self.capture, single, "--column", "rate_radps=rate_x_radps:rad/s", "--column", "temperature_degC=temperature_degC")
        assert "fraction" in self.held("diagnose", single, "--quiet")["unexplained"]

    def check_fleet(self):
        """All result files of a fleet with effects on three axes of one gyro, and a gyro that fails."""
        (self.folder / "lot.toml").write_text('type = "T"\n' + "".join(f'[[gyro]]\nserial = "G{i}"\ncaptures = ["lot-{i}.csv"]\n' for i in range(7)))
        for i in range(6):
            ran("simulate", self.folder / "three.toml", "--seed", i, "--output", self.folder / f"lot-{i}.csv")
        result = subprocess.run([IFOG, "fleet", self.folder / "lot.toml", "--engine", "local"], capture_output=True, text=True, timeout=200, check=False)
        assert result.returncode == 1 and result.stderr.startswith("G6: "), result
        results = self.folder / "lot.results"
        documents = {path: json.loads(path.read_text()) for path in results.rglob("*.json")}
        for document in documents.values():
            schema.check(document)
        assert {document["schema"] for document in documents.values()} == {f"ifog.{name}/1" for name in ("diagnosis", "gyro", "measured", "type", "fleet")}
        (effect,) = documents[results / "fleet.json"]["effects"]
        assert effect["axis"] == "x" and effect["found"] == 6, effect

    def check_replay(self):
        options = ["--driver", "kvh1750", "--option", "format=b"]
        ran("convert", self.capture, self.folder / "r.kvh", *options)
        for speed in (0, 1000):
            sent = self.held("replay", self.folder / "r.kvh", *options, "--block", 40, "--rate", 50, "--speed", speed, "--to", f"file:{self.folder}/sent.kvh")
            assert (sent["lateness_us"] is None) == (speed == 0), sent

    def check_drivers(self):
        found = self.held("drivers")
        assert {"kvh1750", "dbc"} <= {driver["name"] for driver in found["drivers"]}
        assert [driver["name"] for driver in self.held("drivers", "dsp3000")["drivers"]] == ["dsp3000"]
        # An invalid plugin is rejected, and the list has the reason.
        (self.folder / "plugins").mkdir()
        (self.folder / "plugins" / "broken.so").write_text("no object\n")
        said = subprocess.run([IFOG, "drivers", "--json", "-"], capture_output=True, text=True, check=True, env={"IFOG_PLUGIN_PATH": str(self.folder / "plugins")})
        document = json.loads(said.stdout)
        schema.check(document)
        assert document["refused"][0]["path"].endswith("broken.so") and "name" in document["drivers"][0], document["refused"]

    def check_the_command_line(self):
        document = json.loads(ran("--describe"))
        schema.check(document)
        assert {"allan", "diagnose"} <= {command["name"] for command in document["commands"]}

    def check_truth(self):
        schema.check(json.loads(self.truth.read_text()))

    def check_every_schema_that_is_written_is_there_and_tried(self):
        written = {name for path in (SOURCE / "tools").rglob("*.cpp") for name in re.findall(r'"(ifog\.\w+/\d+)"', path.read_text())}
        assert len(written) >= 9, written
        for name in written:
            schema.of(name)
        files = {f"ifog.{path.name.removesuffix('.schema.json').replace('-', '/')}" for path in schema.FOLDER.iterdir()}
        assert files == written, f"schemas that nobody writes, or the other way round: {files ^ written}"

    def check_the_check(self):
        """A removed key, an added one, another type: each fails."""
        good = json.loads(self.truth.read_text())
        for spoil in (lambda d: d.pop("seed"), lambda d: d.update(news=1), lambda d: d["noise"].update(N="loud"), lambda d: d["noise"].update(M=1)):
            bad = json.loads(json.dumps(good))
            spoil(bad)
            try:
                schema.check(bad)
            except AssertionError:
                continue
            raise AssertionError(f"a spoilt document passes: {bad}")


def main():
    if schema.jsonschema is None:
        print("no python3-jsonschema for this Python; tools/install-packages test installs it")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        return 1 if each_check.failures_of(Checks(pathlib.Path(folder))) else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The programs of today on the files of the versions before: read as they were, meaning what they meant.

usage: run.py PATH_OF_IFOG PATH_OF_IFOGD MESSAGES_FOR_PYTHON SOURCE_DIR
"""
import csv
import importlib
import json
import math
import pathlib
import subprocess
import sys
import tempfile

IFOG, IFOGD, MESSAGES, SOURCE = sys.argv[1:]
HERE = pathlib.Path(__file__).resolve().parent
# The hash of each LCM type: programs elsewhere decode by it. Another hash is another message, and nobody hears it.
FINGERPRINTS = {"rate_t": 0x03EB16B05E9D75D5, "status_t": 0x581F79C7F656635F, "imu_t": 0x85AA223FBF2C3588, "inertial_t": 0xA56D6923F5FE98A2,
                "channel_t": 0x0324F6FFDF9266FD}


def ran(*command):
    result = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120, check=False)
    assert result.returncode == 0, f"{' '.join(map(str, command))}: exit {result.returncode}: {result.stderr.strip()}"
    return result.stdout


def columns(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {name: [float(row[name]) if row[name] not in ("", "nan") else math.nan for row in rows] for name in rows[0]}


def same(found, kept, relative=0.0):
    assert set(kept) <= set(found), f"columns {sorted(kept)} became {sorted(found)}"
    for name, values in kept.items():
        assert len(found[name]) == len(values), f"{name}: {len(found[name])} rows, {len(values)} before"
        for row, (a, b) in enumerate(zip(found[name], values)):
            assert (math.isnan(a) and math.isnan(b)) or abs(a - b) <= relative * abs(b), f"{name}, row {row + 1}: {a!r}, {b!r} before"


def takes(option):
    """Whether it takes a value, and whether it may be repeated. What is false stands in no stored file."""
    return (bool(option.get("value")), bool(option.get("repeats")))


def narrower(new, old, where=""):
    """Whether whatever is written by the new schema is what a reader of the old one expects: a list of what is not."""
    wrong = []
    if "type" in old and "type" in new:
        more = set(new["type"] if isinstance(new["type"], list) else [new["type"]]) - set(old["type"] if isinstance(old["type"], list) else [old["type"]])
        if more - ({"integer"} if "number" in old["type"] else set()):
            wrong.append(f"{where} may be {sorted(more)} now")
    if "enum" in old and not set(new.get("enum", ["anything"])) <= set(old["enum"]):
        wrong.append(f"{where} may be {sorted(set(new.get('enum', ['anything'])) - set(old['enum']))} now")
    wrong += [f"{where}.{key} may be missing now" for key in old.get("required", []) if key not in new.get("required", [])]
    for key, value in old.get("properties", {}).items():
        if key not in new.get("properties", {}):
            wrong.append(f"{where}.{key} is gone")
        else:
            wrong += narrower(new["properties"][key], value, f"{where}.{key}")
    for key in ("items", "additionalProperties"):
        if isinstance(old.get(key), dict) and isinstance(new.get(key), dict):
            wrong += narrower(new[key], old[key], f"{where}[]")
    if len(old.get("anyOf", [])) != len(new.get("anyOf", [])):
        wrong.append(f"{where} has other alternatives now")
    for a, b in zip(new.get("anyOf", []), old.get("anyOf", [])):
        wrong += narrower(a, b, where)
    for name, value in old.get("$defs", {}).items():
        wrong += narrower(new.get("$defs", {}).get(name, {}), value, f"{where}/{name}")
    return wrong


class Version:
    def __init__(self, folder, work):
        self.folder, self.work = folder, work

    def converted(self, name):
        out = self.work / "out.csv"
        ran(IFOG, "convert", self.folder / name, out)
        return columns(out)

    def check_capture(self):
        same(self.converted("capture.csv"), columns(self.folder / "capture.csv"))

    def check_flight_recording(self):
        same(self.converted("recording.ifr"), columns(self.folder / "recording.csv"))

    def check_lcm_log(self):
        same(self.converted("messages.lcm"), columns(self.folder / "messages.csv"))

    def check_model(self):
        """It takes from the rate what it took. (What the filter then makes of it may get better.)"""
        out = self.work / "denoised.csv"
        # The model has a warm_up; that the capture begins at power-up has to be told since.
        ran(IFOG, "denoise", self.folder / "capture.csv", "--model", self.folder / "model.toml", "--output", out,
            "--since-power-up", "0")
        same(columns(out), columns(self.folder / "compensated.csv"), 1e-12)

    def check_configuration(self):
        ran(IFOGD, "--config", self.folder / "ifogd.toml", "--check")

    def check_command_line(self):
        before, now = json.loads((self.folder / "command_line.json").read_text()), json.loads(ran(IFOG, "--describe"))
        commands = {command["name"]: command for command in now["commands"]}
        for command in before["commands"]:
            assert command["name"] in commands, f"ifog {command['name']} is gone"
            options = {name: option for option in commands[command["name"]]["options"] for name in option["names"]}
            for option in command["options"]:
                for name in option["names"]:
                    assert name in options, f"ifog {command['name']} {name} is gone"
                    assert takes(options[name]) == takes(option), f"ifog {command['name']} {name} takes something else"
                    gone = set(option.get("choices", [])) - set(options[name]["choices"]) if options[name]["choices"] else set()
                    assert not gone, f"ifog {command['name']} {name}: {sorted(gone)} is gone"
            known = {name for option in command["options"] for name in option["names"]}
            asked = [name for name, option in options.items() if option["required"] and not known.intersection(option["names"])]
            assert not asked, f"ifog {command['name']} must be given {asked} now"

    def check_schemas(self):
        for path in sorted((self.folder / "schemas").iterdir()):
            now = SOURCE + "/tools/ifog/schemas/" + path.name
            assert pathlib.Path(now).exists(), f"{path.name} is gone"
            wrong = narrower(json.loads(pathlib.Path(now).read_text()), json.loads(path.read_text()))
            assert not wrong, f"{path.name}: {'; '.join(wrong)}: that takes the next number, /2"


def check_fingerprints():
    sys.path.insert(0, MESSAGES)
    types = importlib.import_module("ifog")
    for name, known in FINGERPRINTS.items():
        found = int.from_bytes(getattr(types, name)._get_packed_fingerprint(), "big")
        assert found == known, f"ifog.{name} is {found:016x}, was {known:016x}: a change wants a new type beside it, or, before 1.0, the next minor version"


def check_the_comparison_of_schemas():
    old = {"required": ["a"], "properties": {"a": {"type": "number"}, "b": {"type": ["string", "null"]}, "c": {"enum": ["x", "y"]}}}
    fine = {"required": ["a", "b"], "properties": {"a": {"type": "integer"}, "b": {"type": "string"}, "c": {"enum": ["x"]}, "new": {}}}
    assert not narrower(fine, old), narrower(fine, old)
    for spoil in (lambda s: s["required"].remove("a"), lambda s: s["properties"].pop("b"), lambda s: s["properties"]["a"].update(type="string"),
                  lambda s: s["properties"]["c"]["enum"].append("z"), lambda s: s["properties"]["a"].update(type=["number", "null"])):
        bad = json.loads(json.dumps(old))
        spoil(bad)
        assert narrower(bad, old), f"passes: {bad}"


def main():
    failed = 0
    with tempfile.TemporaryDirectory() as work:
        checks = [("LCM types", check_fingerprints), ("the comparison of schemas", check_the_comparison_of_schemas)]
        for folder in sorted(path for path in HERE.iterdir() if path.is_dir()):
            version = Version(folder, pathlib.Path(work))
            checks += [(f"{folder.name}: {name[6:].replace('_', ' ')}", getattr(version, name)) for name in sorted(dir(Version)) if name.startswith("check_")]
        for name, check in checks:
            try:
                check()
                print(f"ok       {name}")
            except AssertionError as error:
                failed += 1
                print(f"FAILED   {name}: {error}")
        assert len(checks) >= 9, checks
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

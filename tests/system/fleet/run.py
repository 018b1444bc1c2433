#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A lot of simulated gyros through `ifog fleet` on this machine's processors: results, restart, failures, the type's effect.

usage: run.py PATH_OF_IFOG SOURCE_DIR
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib

IFOG, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
sys.path.insert(0, str(SOURCE / "tests/system/command_line"))
import schema  # noqa: E402

import lot  # noqa: E402


def fleet(folder, *arguments, expect=0):
    result = subprocess.run([IFOG, "fleet", "lot.toml", "--engine", "local", *arguments], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                            timeout=280, check=False)
    assert result.returncode == expect, f"exit {result.returncode}, expected {expect}: {result.stdout}{result.stderr}"
    return result.stdout, result.stderr


def check_the_lot(folder):
    out, err = fleet(folder, "--jobs", "2")
    assert err == "", err
    results = folder / "lot.results"
    document = json.loads((results / "fleet.json").read_text())
    if schema.jsonschema is not None:
        for path in [results / "fleet.json", results / "type.json", *results.glob("gyros/*/gyro.json"), *results.glob("gyros/*/measured-*.json"),
                     *results.glob("gyros/*/diagnosis.json")]:
            schema.check(json.loads(path.read_text()))
    (effect,) = document["effects"]
    assert effect["channel"] == "temperature_degC" and effect["form"] == "linear", effect
    found = {gyro["serial"] for gyro in effect["gyros"] if gyro["found"]}
    assert len(found & set(lot.WITH)) >= 0.9 * len(lot.WITH), f"found in {sorted(found)}"
    assert not found & set(lot.CLEAN), f"found in clean gyros: {sorted(found & set(lot.CLEAN))}"
    assert abs(effect["prior"]["mean"] - lot.COEFFICIENT) < 4 * effect["prior"]["mean_std_error"], effect["prior"]
    for gyro in effect["gyros"]:
        model = tomllib.loads((results / "gyros" / gyro["serial"] / "with_prior.toml").read_text())
        has = [each for each in model.get("effect", []) if each["form"] == "linear" and each.get("channel") == "temperature_degC"]
        assert len(has) == gyro["found"], (gyro, model)
        if gyro["found"]:
            assert gyro["with_prior"]["std_error"] < gyro["own"]["std_error"]
            assert has[0]["parameter"][0]["value"] == gyro["with_prior"]["value"]
    page = (results / "fleet.html").read_text()
    assert "linear in temperature" in page and 'href="gyros/G01/report.html"' in page and "</html>" in page
    assert "the type has an effect linear in temperature" in out, out


def check_single_diagnosis_is_the_same(folder):
    own = folder / "own.json"
    subprocess.run([IFOG, "diagnose", "G01.csv", "--quiet", "--json", own], cwd=folder, check=True, timeout=100)
    assert own.read_text() == (folder / "lot.results/gyros/G01/diagnosis.json").read_text()


def check_the_daemons_code_takes_the_model(folder):
    subprocess.run([IFOG, "denoise", "G01.csv", "--model", "lot.results/gyros/G01/with_prior.toml", "--output", "corrected.csv"], cwd=folder, check=True,
                   capture_output=True, timeout=100)


def stamps(folder):
    return {path: path.stat().st_mtime_ns for path in (folder / "lot.results/gyros").rglob("gyro.json")}


def check_restart_takes_up_what_is_missing(folder):
    before = stamps(folder)
    fleet(folder)
    assert stamps(folder) == before, "diagnosed again without need"
    shutil.rmtree(folder / "lot.results/gyros/G03")
    assert fleet(folder, "--dry-run")[0].split()[-2:] == ["--one", "2"]
    fleet(folder)
    after = stamps(folder)
    changed = {path for path in after if after[path] != before.get(path)}
    assert {path.parent.name for path in changed} == {"G03"}, changed
    # A capture that is another now is diagnosed anew; one half-written result is none.
    os.utime(folder / "G04.csv")
    (folder / "lot.results/gyros/G05/gyro.json").write_text('{"schema": "ifog.gy')
    fleet(folder)
    assert {path.parent.name for path in after if stamps(folder)[path] != after[path]} == {"G04", "G05"}


def check_a_failed_gyro_is_one_line(folder):
    kept = (folder / "G02.csv").read_text()
    (folder / "G02.csv").write_text("no capture\n")
    _, err = fleet(folder, expect=1)
    assert err.count("\n") == 1 and err.startswith("G02: ") and "G02.csv" in err, err
    document = json.loads((folder / "lot.results/fleet.json").read_text())
    assert [each["serial"] for each in document["failed"]] == ["G02"] and len(document["effects"]) == 1
    (folder / "G02.csv").write_text(kept)
    assert fleet(folder)[1] == ""


def check_bad_manifests(folder):
    good = '[[gyro]]\nserial = "A"\ncaptures = ["a.csv"]\n'
    for text, said in ((good, "type is missing"), ('type = "T"\n', "gyro is missing"), ('type = "T"\n' + good + "day = 1\n", "bad.toml:5: key 'day' is unknown"),
                       ('type = "T"\n' + good.replace('"A"', '"$(touch pwned)"'), "expected up to 64 letters"),
                       ('type = "T"\n' + good.replace('"A"', '"../A"'), "expected up to 64 letters"),
                       ('type = "T"\n' + good + good.replace('"A"', '"a"'), "stands twice"), ('type = "T"\n' + good.replace('["a.csv"]', "[]"), "expected a list of paths"),
                       ('type = "T"\n' + good.replace('["a.csv"]', "[7]"), "expected a list of paths")):
        (folder / "bad.toml").write_text(text)
        result = subprocess.run([IFOG, "fleet", "bad.toml"], cwd=folder, capture_output=True, text=True, timeout=60, check=False)
        assert result.returncode == 1 and said in result.stderr and result.stderr.count("\n") == 1, (text, result)
    for arguments in (["--one", "99"], ["--engine", "mpi"], ["--jobs", "0"]):
        assert subprocess.run([IFOG, "fleet", "lot.toml", *arguments], cwd=folder, capture_output=True, timeout=60, check=False).returncode == 2, arguments


def check_no_shell_reads_the_manifest(folder):
    """A capture's name that a shell would run, and the script for Slurm: its index is all that stands there."""
    name = "a'; touch pwned; $(touch pwned) `touch pwned` .csv"
    shutil.copy(folder / "G01.csv", folder / name)
    (folder / "hostile.toml").write_text(f"type = \"T'; touch pwned\"\n[[gyro]]\nserial = \"H\"\ncaptures = [{json.dumps(name)}]\n")
    subprocess.run([IFOG, "fleet", "hostile.toml", "--engine", "local"], cwd=folder, check=True, capture_output=True, timeout=100)
    script = subprocess.run([IFOG, "fleet", "hostile.toml", "--engine", "slurm", "--results", "another ' one", "--dry-run"], cwd=folder, check=True,
                            capture_output=True, text=True, timeout=60).stdout
    assert "touch" not in script and "#SBATCH --array=0\n" in script and subprocess.run(["sh", "-n"], input=script, text=True, check=False).returncode == 0, script
    # Run by hand it does what Slurm would do.
    subprocess.run(["sh"], input=script, text=True, cwd=folder, env={**os.environ, "SLURM_ARRAY_TASK_ID": "0"}, check=True, timeout=100)
    assert (folder / "another ' one/gyros/H/gyro.json").is_file()
    assert not list(folder.rglob("pwned"))


def main():
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        lot.make(IFOG, folder)
        for check in (check_the_lot, check_single_diagnosis_is_the_same, check_the_daemons_code_takes_the_model, check_restart_takes_up_what_is_missing,
                      check_a_failed_gyro_is_one_line, check_bad_manifests, check_no_shell_reads_the_manifest):
            try:
                check(folder)
                print(f"ok       {check.__name__[6:].replace('_', ' ')}", flush=True)
            except AssertionError as error:
                failed += 1
                print(f"FAILED   {check.__name__[6:].replace('_', ' ')}: {error}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

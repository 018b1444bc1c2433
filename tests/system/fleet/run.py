#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Simulated gyros with `ifog fleet` on this computer: results, restart, failures, the type's effect.

usage: run.py PATH_OF_IFOG SOURCE_DIR
"""
import csv
import json
import math
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import tomllib

IFOG, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
DEG_PER_H = math.pi / 180 / 3600
sys.path.insert(0, str(SOURCE / "tests/system/command_line"))
import schema  # noqa: E402

import lot  # noqa: E402
from waiting import wait_for  # noqa: E402


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


def check_a_scale_factor_counts_from_the_bias(folder):
    """The measured rate, which the daemon has, is the true one plus the bias: its correction must not leave scale times bias."""
    bias, scale = 5.0e-2, 3.0e-4
    (folder / "table.scenario").write_text(f"""
seed = 1
sample_rate_hz = 10
duration_s = 600
bias_radps = {bias}
axes = ["z"]
reference = true
reference_noise_radps = 1.0e-7
noise = {{ N = 5.0e-7, B = 5.0e-8 }}
[[motion]]
axis = "z"
kind = "rate_table"
rates_radps = [0.0, 0.1, 0.5, 1.0, 0.0, -0.1, -0.5, -1.0]
dwell_s = 20
edge_s = 1.0
[[effect]]
form = "linear"
channel = "rate"
axis = "z"
coefficient = {scale}
""")
    manifest = 'type = "T2"\n'
    for seed in range(1, 7):
        subprocess.run([IFOG, "simulate", "table.scenario", "--seed", str(seed), "--output", f"table{seed}.csv"], cwd=folder, check=True, capture_output=True)
        manifest += f'[[gyro]]\nserial = "R{seed}"\ncaptures = ["table{seed}.csv"]\n'
    (folder / "table.toml").write_text(manifest)
    subprocess.run([IFOG, "fleet", "table.toml", "--engine", "local"], cwd=folder, check=True, capture_output=True, timeout=200)
    for seed in range(1, 7):
        (effect,) = [each for each in tomllib.loads((folder / f"table.results/gyros/R{seed}/with_prior.toml").read_text())["effect"] if each["form"] == "linear"]
        assert abs(effect["parameter"][0]["value"] - scale) < 0.02 * scale and abs(effect["reference"] - bias) < 1e-3 * bias, effect


def check_a_bias_goes_with_the_coefficients(folder):
    """Beside a reference, far from 25 °C: what the type changes of a coefficient, the bias takes up, and the mean that is left stays as small."""
    draw = random.Random(4)
    manifest = 'type = "T3"\n'
    for n in range(5):
        per_degC, rows = (0.4 + 0.05 * n) * DEG_PER_H, ["time_s,rate_radps,reference_rate_radps,temp_degC"]
        for i in range(8000):
            truth, degC = 1e-3 * math.sin(0.03 * i), 50 + 1.5 * math.sin(0.0011 * i)
            rows.append(f"{i / 10},{truth + 6e-5 + per_degC * (degC - 50) + draw.gauss(0, 4e-5):.9g},{truth:.9g},{degC:.5f}")
        (folder / f"hot{n}.csv").write_text("\n".join(rows) + "\n")
        manifest += f'[[gyro]]\nserial = "H{n}"\ncaptures = ["hot{n}.csv"]\n'
    (folder / "hot.toml").write_text(manifest)
    subprocess.run([IFOG, "fleet", "hot.toml", "--engine", "local"], cwd=folder, check=True, capture_output=True, timeout=200)
    moved = 0
    for n in range(5):
        gyro = folder / f"hot.results/gyros/H{n}"
        coefficients, left = [], []
        for name in ("model", "with_prior"):
            model = gyro / f"{name}.toml"
            coefficients.append(sum(e["parameter"][0]["value"] for e in tomllib.loads(model.read_text())["effect"] if e["form"] == "linear"))
            subprocess.run([IFOG, "denoise", f"hot{n}.csv", "--model", model, "--output", "left.csv"], cwd=folder, check=True, capture_output=True, timeout=100)
            with open(folder / "left.csv") as file:
                rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
            left.append(sum(float(row["compensated_radps"]) for row in rows) / len(rows) / DEG_PER_H)
        moved = max(moved, abs(coefficients[1] - coefficients[0]) * 25 / DEG_PER_H)
        assert abs(left[1] - left[0]) < 0.02, f"H{n}: a mean of {left[1]:.3f} °/h instead of {left[0]:.3f} is left"
    assert moved > 0.1, f"the type has moved the coefficients by {moved} °/h at most: nothing is tested"


def stamps(folder):
    return {path: path.stat().st_mtime_ns for path in (folder / "lot.results/gyros").rglob("gyro.json")}


def check_restart_takes_up_what_is_missing(folder):
    before = stamps(folder)
    fleet(folder)
    assert stamps(folder) == before, "diagnosed again without need"
    shutil.rmtree(folder / "lot.results/gyros/G03")
    assert fleet(folder, "--dry-run")[0].split()[1:5] == ["fleet", "--one", "2", "lot.toml"]
    fleet(folder)
    after = stamps(folder)
    changed = {path for path in after if after[path] != before.get(path)}
    assert {path.parent.name for path in changed} == {"G03"}, changed
    # A changed capture is diagnosed again; a partial result does not count.
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
    assert not (folder / "lot.results/gyros/G02/with_prior.toml").exists(), "of an earlier run"
    assert (folder / "lot.results/gyros/G01/with_prior.toml").exists()
    (folder / "G02.csv").write_text(kept)
    assert fleet(folder)[1] == ""


def check_a_damaged_result_is_made_again(folder):
    gyros = folder / "lot.results/gyros"
    before = stamps(folder)
    (gyros / "G06/model.toml").unlink()
    (gyros / "G07/diagnosis.json").unlink()
    fleet(folder)
    assert {path.parent.name for path in before if stamps(folder)[path] != before[path]} == {"G06", "G07"}
    for name, text in (("model.toml", "no = [model"), ("diagnosis.json", '{"schema": ')):
        (gyros / "G08" / name).write_text(text)
        _, err = fleet(folder, expect=1)
        assert err.count("\n") == 1 and err.startswith("G08: ") and name in err, err
        document = json.loads((folder / "lot.results/fleet.json").read_text())
        assert [each["serial"] for each in document["failed"]] == ["G08"] and len(document["effects"]) == 1
        assert not (gyros / "G08/with_prior.toml").exists()
        assert fleet(folder)[1] == ""
        assert (gyros / "G08/with_prior.toml").exists()


def check_a_measurement_of_other_inputs_is_none(folder):
    """A failure for other captures is neither this run's failure nor its measurement."""
    (path,) = [each for each in (folder / "lot.results/gyros/G09").glob("measured-*.json")
               if json.loads((folder / "lot.results/type.json").read_text())["id"] in each.name]
    kept = json.loads(path.read_text())
    for change in ({"inputs": "0" * 16}, {"failed": "of yesterday", "axes": []}, {"inputs": "0" * 16, "failed": "of yesterday", "axes": []}):
        path.write_text(json.dumps({**kept, **change}))
        assert fleet(folder)[1] == ""
        assert json.loads(path.read_text()) == kept, change


def one_gyro(folder, name, *arguments, captures=("G01.csv",), expect=0, environment=None):
    """With its own manifest."""
    (folder / name).write_text(f'type = "T"\n[[gyro]]\nserial = "A"\ncaptures = {json.dumps(captures)}\n')
    result = subprocess.run([IFOG, "fleet", *arguments], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=100, check=False,
                            env=environment)
    assert result.returncode == expect, result
    return result


def check_nothing_of_an_earlier_run_stays_when_none_is_diagnosed(folder):
    shutil.copy(folder / "G01.csv", folder / "only.csv")
    one_gyro(folder, "only.toml", "only.toml", "--engine", "local", captures=("only.csv",))
    results = folder / "only.results"
    (results / "gyros/A/with_prior.toml").write_text("")
    assert (results / "fleet.json").exists() and (results / "fleet.html").exists()
    (folder / "only.csv").write_text("no capture\n")
    said = one_gyro(folder, "only.toml", "only.toml", "--engine", "local", captures=("only.csv",), expect=1).stderr
    assert "no gyro was diagnosed" in said or said.startswith("A: "), said
    assert not [name for name in ("gyros/A/with_prior.toml", "fleet.json", "fleet.html") if (results / name).exists()]


def check_another_option_is_another_diagnosis(folder):
    """Options of the file's columns, and the content of a bus description with the same name."""
    bus = (SOURCE / "drivers/dbc/examples/ifogd_gyro.dbc").read_text()
    (folder / "bus.dbc").write_text(bus)
    options = ["--dbc", "bus.dbc", "--option", "signal=Rate_x", "--option", "counter=Counter", "--option", "rate_hz=10"]
    subprocess.run([IFOG, "convert", "G01.csv", "bus.log", *options], cwd=folder, check=True, capture_output=True, timeout=60)

    def missing(*more):
        return one_gyro(folder, "bus.toml", "bus.toml", "--engine", "local", "--dry-run", *options, *more, captures=("bus.log",)).stdout

    assert "--one 0" in missing()
    one_gyro(folder, "bus.toml", "bus.toml", "--engine", "local", *options, captures=("bus.log",))
    assert missing() == ""
    for other in (("--group", "/imu"), ("--sample-rate", "5"), ("--only", "id=0"), ("--repeats", "keep"), ("--axis", "x"), ("--from", "1"),
                  ("--significance", "0.02"), ("--earth",), ("--latitude", "48")):
        assert "--one 0" in missing(*other), other
    (folder / "bus.dbc").write_text(bus + "\n")
    assert "--one 0" in missing()
    (folder / "bus.dbc").write_text(bus)
    assert missing() == ""


def check_options_end_where_they_are_said_to(folder):
    one_gyro(folder, "-lot.toml", "--engine", "local", "--results", "ended", "--", "-lot.toml")
    assert (folder / "ended/gyros/A/gyro.json").is_file()
    script = one_gyro(folder, "-lot.toml", "--engine", "slurm", "--results", "again", "--dry-run", "--", "-lot.toml").stdout
    assert 'fleet --one "$gyro" --engine' in script and script.endswith(" -- -lot.toml\n"), script


def check_a_link_in_a_path_is_followed(folder):
    (folder / "far/inside").mkdir(parents=True)
    (folder / "near").symlink_to("far/inside")
    shutil.copy(folder / "G01.csv", folder / "far/there.csv")  # near/../there.csv is not ./there.csv
    one_gyro(folder, "linked.toml", "linked.toml", "--engine", "local", captures=("near/../there.csv",))


def check_what_squeue_warns_of_is_no_job(folder):
    programs = folder / "programs"
    programs.mkdir()
    # As if the job ran before Slurm answers.
    (programs / "sbatch").write_text("#!/bin/sh\ncat >script; SLURM_ARRAY_TASK_ID=0 sh script >/dev/null; echo 7\n")
    (programs / "squeue").write_text("#!/bin/sh\necho 'squeue: warning: 12 jobs, 3_4 more' >&2\necho\n")
    for each in programs.iterdir():
        each.chmod(0o755)
    said = one_gyro(folder, "queued.toml", "queued.toml", "--engine", "slurm", environment={**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"}).stdout
    assert "submitted the array 7" in said and "1 of 1 gyros diagnosed" in said, said


def children_of(process):
    return pathlib.Path(f"/proc/{process}/task/{process}/children").read_text().split()


def is_running(process):
    try:
        return pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] not in "ZX"
    except OSError:
        return False


def check_no_child_outlives_the_run(folder):
    os.mkfifo(folder / "never.csv")  # whoever opens it waits
    (folder / "waits.toml").write_text('type = "T"\n[[gyro]]\nserial = "A"\ncaptures = ["never.csv"]\n')
    for number in (signal.SIGKILL, signal.SIGHUP, signal.SIGINT):
        run = subprocess.Popen([IFOG, "fleet", "waits.toml", "--engine", "local"], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL))
        (child,) = wait_for("a child", lambda run=run: children_of(run.pid))
        wait_for("its own program", lambda child=child: "--one" in pathlib.Path(f"/proc/{child}/cmdline").read_text())
        run.send_signal(number)
        _, said = run.communicate(timeout=60)
        assert run.returncode == (1 if number == signal.SIGINT else -number), (number, run.returncode, said)
        assert number != signal.SIGINT or "interrupted" in said, said
        wait_for(f"end of the child after signal {number}", lambda child=child: not is_running(child))


def check_bad_manifests(folder):
    (folder / "a.csv").touch()
    (folder / "link.csv").symlink_to("a.csv")
    (folder / "x").mkdir()
    good = '[[gyro]]\nserial = "A"\ncaptures = ["a.csv"]\n'
    for text, said in ((good, "type: missing"), ('type = "T"\n', "gyro: missing"), ('type = "T"\n' + good + "day = 1\n", "bad.toml:5: gyro.day: unknown key"),
                       ('type = "T"\n' + good.replace('"A"', '"$(touch pwned)"'), "expected up to 64 letters"),
                       ('type = "T"\n' + good.replace('"A"', '"../A"'), "expected up to 64 letters"),
                       ('type = "T"\n' + good + good.replace('"A"', '"a"'), "stands twice"), ('type = "T"\n' + good.replace('["a.csv"]', "[]"), "expected a list of paths"),
                       ('type = "T"\n' + good.replace('["a.csv"]', "[7]"), "expected a list of texts"),
                       ('type = "T"\n' + good + good.replace('"A"', '"B"').replace("a.csv", "./x/../a.csv"), "bad.toml:7: gyro.captures holds './x/../a.csv', which is a capture of 'A' already"),
                       ('type = "T"\n' + good.replace('["a.csv"]', '[\n  "a.csv",\n  "link.csv"]'), "bad.toml:4: gyro.captures holds 'link.csv', which is a capture of 'A' already")):
        (folder / "bad.toml").write_text(text)
        result = subprocess.run([IFOG, "fleet", "bad.toml"], cwd=folder, capture_output=True, text=True, timeout=60, check=False)
        assert result.returncode == 1 and said in result.stderr and result.stderr.count("\n") == 1, (text, result)
    for arguments in (["--one", "99"], ["--engine", "mpi"], ["--jobs", "0"]):
        assert subprocess.run([IFOG, "fleet", "lot.toml", *arguments], cwd=folder, capture_output=True, timeout=60, check=False).returncode == 2, arguments


def check_no_shell_reads_the_manifest(folder):
    """A capture's name that a shell would execute, and the script for Slurm, which contains only the index."""
    name = "a'; touch pwned; $(touch pwned) `touch pwned` .csv"
    shutil.copy(folder / "G01.csv", folder / name)
    (folder / "hostile.toml").write_text(f"type = \"T'; touch pwned\"\n[[gyro]]\nserial = \"H\"\ncaptures = [{json.dumps(name)}]\n")
    subprocess.run([IFOG, "fleet", "hostile.toml", "--engine", "local"], cwd=folder, check=True, capture_output=True, timeout=100)
    script = subprocess.run([IFOG, "fleet", "hostile.toml", "--engine", "slurm", "--results", "another ' one", "--dry-run"], cwd=folder, check=True,
                            capture_output=True, text=True, timeout=60).stdout
    assert "touch" not in script and "#SBATCH --array=0\n" in script and subprocess.run(["sh", "-n"], input=script, text=True, check=False).returncode == 0, script
    # Run manually, it does what Slurm would do.
    subprocess.run(["sh"], input=script, text=True, cwd=folder, env={**os.environ, "SLURM_ARRAY_TASK_ID": "0"}, check=True, timeout=100)
    assert (folder / "another ' one/gyros/H/gyro.json").is_file()
    assert not list(folder.rglob("pwned"))


def main():
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        lot.make(IFOG, folder)
        for check in (check_the_lot, check_single_diagnosis_is_the_same, check_the_daemons_code_takes_the_model, check_a_scale_factor_counts_from_the_bias, check_a_bias_goes_with_the_coefficients, check_restart_takes_up_what_is_missing,
                      check_a_failed_gyro_is_one_line, check_a_damaged_result_is_made_again, check_a_measurement_of_other_inputs_is_none,
                      check_nothing_of_an_earlier_run_stays_when_none_is_diagnosed, check_another_option_is_another_diagnosis,
                      check_options_end_where_they_are_said_to, check_a_link_in_a_path_is_followed, check_what_squeue_warns_of_is_no_job,
                      check_no_child_outlives_the_run, check_bad_manifests, check_no_shell_reads_the_manifest):
            try:
                check(folder)
                print(f"ok       {check.__name__[6:].replace('_', ' ')}", flush=True)
            except AssertionError as error:
                failed += 1
                print(f"FAILED   {check.__name__[6:].replace('_', ' ')}: {error}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

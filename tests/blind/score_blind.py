#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Scores `ifog diagnose` as a stranger would: only by the command line, on sensors it knows nothing of.

For each seed: two captures are made (make_blind.py), the first is diagnosed with --json and --write-model, both
are corrected by `ifog denoise --model`, and what the model takes away is held against the hidden effect. The rule of
every verdict stands in judge.py. Exit 1 when a bound given by --require is missed, or a program fails."""
import argparse
import concurrent.futures
import json
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import numpy as np
except ModuleNotFoundError:
    sys.exit("score_blind: numpy is missing for this Python; install python3-numpy")

import judge
import signals
import tables
from kinds import KINDS
from make_blind import write
from sensor import make

PROCESSOR_SECONDS_ALLOWED = 180


def read_csv(path):
    """Columns of a CSV of numbers by name; an empty cell is nan."""
    with open(path) as f:
        names = f.readline().strip().split(",")
        cells = f.read().replace("\n", ",").split(",")[:-1]
    values = np.array([float(c) if c else np.nan for c in cells]).reshape(-1, len(names))
    return dict(zip(names, values.T))


def run(command):
    """(exit code, what it said, processor seconds); the kernel ends what takes too long, however busy the machine."""
    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_SECONDS_ALLOWED, PROCESSOR_SECONDS_ALLOWED))

    def used():
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        return children.ru_utime + children.ru_stime

    began = used()
    p = subprocess.run(command, capture_output=True, text=True, preexec_fn=limit)
    said = p.stderr[-400:] + (" (does not end)" if p.returncode in (-signal.SIGXCPU, -signal.SIGKILL) else "")
    return p.returncode, said, used() - began


class Failed(Exception):
    pass


class Refused(Exception):
    pass


def checked(command):
    code, said, seconds = run(command)
    if code == 1 and "ifog:" in said:
        raise Refused(f"{command[1]}: {said.strip().replace(str(command[2]), command[2].name)}")
    if code != 0:
        raise Failed(f"{command[1]} {command[2].name}: exit {code}: {said.strip()}")
    return seconds


def corrected(ifog, folder, name, model, axis, cold):
    """What the model takes from the rate, row by row, and what it leaves. `cold`: it begins at power-up, which
    whoever records it knows and tells."""
    out = folder / f"{name}_out.csv"
    checked([ifog, "denoise", folder / f"{name}.csv", "--model", model, "--output", out]
            + (["--since-power-up", "0"] if cold else []))
    columns = read_csv(out)
    raw, left = columns[f"raw_{axis}radps"], columns[f"compensated_{axis}radps"]
    return columns["time_s"], raw - left, left


def on_rows(t, times, x):
    """x at the capture's rows; denoise may leave rows out."""
    if len(times) == len(t):
        return x
    at = np.clip(np.searchsorted(times, t - 1e-6), 0, len(times) - 1)
    return np.where(np.abs(times[at] - t) < 1e-3, x[at], np.nan)


def judged(ifog, seed, only, several, folder):
    """The record of one sensor."""
    sensor = make(seed, only, several)
    truth, (fit, second, *more) = sensor.truth, sensor.captures
    write(sensor, folder, folder / "truth")
    axis = "x_" if any(name.startswith("rate_x") for name in fit.columns) else ""
    given = [folder / "capture1.csv"] + [folder / "capture2.csv"] * len(more)
    command = [ifog, "diagnose", *given, "--json", folder / "d.json", "--write-model",
               folder / "m.toml", "--report", folder / "d.html", "--quiet"] + (["--axis", "x"] if axis else [])
    record = {"seed": seed, "truth": truth, "verdict": "failed", "failure": None, "error": None, "unfounded": [],
              "claims": [], "contradictions": [], "odd_words": [], "worse": False}
    try:
        record["seconds"] = checked(command)
        report = json.loads((folder / "d.json").read_text())
        if not (folder / "m.toml").exists():
            raise Failed("diagnose: exit 0 without the model it was told to write")
        dt = 1 / truth["sample_rate_hz"]
        seconds = dt if "ramp" in truth["kind"] else 10.0
        times, took, _ = corrected(ifog, folder, "next", folder / "m.toml", axis, not truth["outside"])
        took = on_rows(second.t, times, took)
        error = judge.errors(second, took, dt, seconds)
        whole = not any(truth["accidents"]) and not truth["outside"]
        record["heading_square"] = judge.heading_square(second, took, report, dt) if whole else None
        times, took, left = corrected(ifog, folder, "capture1", folder / "m.toml", axis, True)
        reference = fit.columns.get(f"reference_rate_{axis}radps", 0.0)
        before = signals.rms(fit.columns[f"rate_{axis}radps"] - reference, dt)
        after = signals.rms(on_rows(fit.t, times, left) - reference, dt)
        record["fit"] = judge.errors(fit, on_rows(fit.t, times, took), dt, seconds)
    except (Refused, Failed, KeyError, ValueError) as failure:
        record["verdict"] = "refused" if isinstance(failure, Refused) else "failed"
        record["failure"] = f"{type(failure).__name__}: {failure}"
        return record
    record.update(
        error=error, verdict=judge.verdict(truth, report, error), unfounded=judge.unfounded(report, truth),
        coefficient_error=judge.coefficient_error(report, truth),
        claims=[f"{form} of {' and '.join(used)}" if used else form for form, used, _ in judge.claims_of(report)],
        named=[judge.named(report, e) for e in truth["effects"]],
        contradictions=judge.contradictions(report, before, after), odd_words=judge.odd_words(report),
        unexplained=report.get("unexplained"),
        remarks=report.get("remarks", []), worse=error["total_after"] > 1.1 * error["total_before"])
    return record


def score(job):
    ifog, seed, only, several, keep = job
    folder = Path(keep) / str(seed) if keep else Path(tempfile.mkdtemp(prefix="blind."))
    folder.mkdir(parents=True, exist_ok=True)
    try:
        return judged(ifog, seed, only, several, folder)
    finally:
        if not keep:
            shutil.rmtree(folder, ignore_errors=True)


def scored(options):
    seeds = options.only or range(options.first, options.first + options.count)
    records = []
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        for record in pool.map(score, [(options.ifog, s, options.kind, options.captures > 1, options.keep)
                                          for s in seeds]):
            records.append(record)
            print(tables.line(record), flush=True)
    return records


def requirements(summary, wanted):
    """Bounds NAME<=VALUE or NAME>=VALUE on the summary's shares; those missed, as text."""
    missed = []
    for bound in wanted:
        name, sign, value = bound.partition("<=") if "<=" in bound else bound.partition(">=")
        found = summary[name]
        if not (found <= float(value) if sign == "<=" else found >= float(value)):
            missed.append(f"{name} is {found}, wanted {sign} {value}")
    return missed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ifog", help="the program")
    parser.add_argument("--join", nargs="*", help="score nothing; one table of the JSON files of earlier runs")
    parser.add_argument("--first", type=int, default=1, help="seed")
    parser.add_argument("--count", type=int, default=19)
    parser.add_argument("--only", type=int, nargs="*", help="these seeds")
    parser.add_argument("--kind", choices=list(KINDS), help="every sensor of this kind")
    parser.add_argument("--captures", type=int, choices=(1, 2), default=1, help="diagnosed together")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--json", help="all records and the summary")
    parser.add_argument("--markdown", help="the tables")
    parser.add_argument("--keep", help="folder to leave captures and reports in, by seed")
    parser.add_argument("--require", nargs="*", default=[], help="bounds on the summary: crashed<=0 worse<=0.005")
    options = parser.parse_args()
    if options.join:
        records = [r for name in options.join for r in json.loads(Path(name).read_text())["sensors"]]
    elif options.ifog:
        records = scored(options)
    else:
        parser.error("--ifog or --join is needed")
    summary = tables.summary(records)
    text = tables.markdown(records, summary)
    print("\n" + text)
    if options.json:
        Path(options.json).write_text(json.dumps({"schema": "ifog.blind_score/1", "summary": summary,
                                                  "sensors": records}, indent=1, default=float) + "\n")
    if options.markdown:
        Path(options.markdown).write_text(text)
    missed = requirements(summary, options.require)
    for text in missed:
        print("missed:", text)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())

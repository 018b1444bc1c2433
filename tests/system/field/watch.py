#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The watch of `ifog adopt` with its defaults: ten minutes of real time with a gyro in real time. Once the promise is kept, and once
the gyro's effect has changed sign.

usage: watch.py BUILD [FOLDER to keep]

By name only: half an hour, mostly waiting. In its own network namespace. One line per check, `ok` or `FAILED`; exit 77, with the
reason, if something required is missing.
"""
import os
import shutil
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import run  # noqa: E402
import slow_gyro  # noqa: E402

# The watch covers more than one temperature cycle, which is necessary to evaluate the mean of an effect.
slow_gyro.CYCLE_S = 400


def watched(field, day, verdict, code):
    """Adopts the proposal with the default watch while `day` arrives in real time."""
    seen = field.published()
    feeder = field.feed(day, 1)
    field.await_(lambda: field.published() > seen + 10 * run.HZ, "the gyro to begin")
    began = time.monotonic()
    said, adopted = field.of("adopt", "nose", code=code, seconds=900)
    took = time.monotonic() - began
    print("        " + said.replace("\n", "\n        "))
    field.check(adopted is not None and adopted["verdict"] == verdict, f"the promise: {verdict}, exit {code}")
    field.check(adopted is not None and 590 < adopted["watched_s"] < 630 and took > 590, f"after ten minutes: {took:.0f} s")
    sensor = field.sensor()
    field.check(sensor["books"]["balanced"] and not any(sensor["losses"].values()), "nothing was lost")
    # While running: a model is used from the next sample on.
    said = field.run("revert", "nose", "--config", field.config)
    field.check("model none is in place again" in said, "and back")
    feeder.terminate()
    feeder.wait()


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    run.private_network.enter()
    keep = len(sys.argv) == 3
    work = sys.argv[2] if keep else tempfile.mkdtemp()
    os.makedirs(work, exist_ok=True)
    field = run.Field(sys.argv[1], os.path.abspath(work))
    try:
        field.make()
        field.first_day()
        field.first_night()
        watched(field, 2, "kept", 0)
        # Another gyro, whose frames count from the beginning.
        field.check(field.stop() == 0, "the daemon ends well")
        open(field.path("log"), "w").close()
        field.start()
        for name in os.listdir(field.path("as-proposed")):
            if name.startswith("nose.proposal"):
                shutil.copy(field.path(os.path.join("as-proposed", name)), field.state)
        watched(field, run.TURNED_OVER, "broken", 1)
        field.check(field.stop() == 0, "the daemon ends well")
    finally:
        if field.daemon is not None:
            field.daemon.kill()
            field.daemon.wait()
        if field.failed:
            print(open(field.path("log")).read()[-2000:])
        if not keep:
            shutil.rmtree(work, ignore_errors=True)
    sys.exit(field.failed > 0)


if __name__ == "__main__":
    main()

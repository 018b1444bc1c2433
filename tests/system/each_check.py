# SPDX-License-Identifier: Apache-2.0
"""Runs the methods check_SOMETHING of an object; prints one line each, `ok` or `FAILED` with the reason. Runs programs meanwhile."""
import contextlib
import subprocess


@contextlib.contextmanager
def running(*words, **more):
    """A program that is killed when it is left."""
    with subprocess.Popen(words, text=True, **more) as program:
        try:
            yield program
        finally:
            program.kill()


def failures_of(checks):
    failed = 0
    for name in sorted(each for each in dir(checks) if each.startswith("check_")):
        try:
            getattr(checks, name)()
            print(f"ok       {name[6:].replace('_', ' ')}")
        except AssertionError as error:
            failed += 1
            print(f"FAILED   {name[6:].replace('_', ' ')}: {error}")
    return failed

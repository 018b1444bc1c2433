# SPDX-License-Identifier: Apache-2.0
"""Runs the methods check_SOMETHING of an object; prints one line each, `ok` or `FAILED` with the reason."""


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

# SPDX-License-Identifier: Apache-2.0
"""The methods check_SOMETHING of an object, one after the other: a line each, `ok` or `FAILED` and why."""


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

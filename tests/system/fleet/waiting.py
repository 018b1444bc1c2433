# SPDX-License-Identifier: Apache-2.0
"""Waiting for another process."""
import time


def wait_for(what, ready, seconds=60):
    """Returns the result of `ready` when it is true."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        value = ready()
        if value:
            return value
        time.sleep(0.1)
    raise AssertionError(f"{what}: not within {seconds} s")

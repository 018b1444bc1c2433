# SPDX-License-Identifier: Apache-2.0
"""For what another process does in its own time."""
import time


def wait_for(what, ready, seconds=60):
    """What `ready` gives once it is true of anything."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        value = ready()
        if value:
            return value
        time.sleep(0.1)
    raise AssertionError(f"{what}: not within {seconds} s")

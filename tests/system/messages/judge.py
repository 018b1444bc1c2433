#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the output of the subscribers with each other and with the sent data. usage: judge.py COUNT FILE..."""
import pathlib
import sys

SENT, RATE_HZ = (0.01, -0.02, 0.03), 500


def main():
    count, files = int(sys.argv[1]), [pathlib.Path(name) for name in sys.argv[2:]]
    by_file = [dict(line.split(" ", 1) for line in path.read_text().splitlines()) for path in files]
    for path, messages in zip(files, by_file):
        if len(messages) != count:
            sys.exit(f"FAILED: {path.name} has {len(messages)} messages, expected {count}")
    common = set.intersection(*(set(messages) for messages in by_file))
    if len(common) < count - 200:
        sys.exit(f"FAILED: only {len(common)} messages in all of {len(files)}")
    for number in sorted(common, key=int):
        said = {messages[number] for messages in by_file}
        if len(said) != 1:
            sys.exit(f"FAILED: message {number}: {said}")
        *values, gap = said.pop().split()
        if len(values) != 6 or gap not in ("-", "gap"):
            sys.exit(f"FAILED: message {number}: {values} {gap}")
        for axis, sent in enumerate(SENT):
            increment, rate = float(values[2 * axis]), float(values[2 * axis + 1])
            # The increment is over a period of the fitted clock; the rate is a float32 on the wire.
            if abs(rate - sent) > 1e-6 or (int(number) > 0 and abs(increment - sent / RATE_HZ) > 0.2 * abs(sent / RATE_HZ)):
                sys.exit(f"FAILED: message {number} axis {axis}: {increment} rad, {rate} rad/s, sent {sent} at {RATE_HZ} Hz")
    print(f"ok       {len(files)} subscribers print the same of {len(common)} messages, and what was sent")


if __name__ == "__main__":
    main()

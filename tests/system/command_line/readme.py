#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The commands of a README, run as printed: every `sh` block in its order, in one shell, from the project's root.

usage: readme.py README SOURCE_DIR BUILD_DIR

The build folder stands in for the one that is printed. LCM stays in a network namespace of its own. Exit 77 where there can be
none. A block that fails is told with its line and what it said.
"""
import os
import pathlib
import re
import subprocess
import sys

README, SOURCE, BUILD = (pathlib.Path(argument) for argument in sys.argv[1:])
INSIDE = "ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo && exec bash -s"


def blocks(text):
    """Each block's first line and its commands."""
    return [(text[:found.start(1)].count("\n") + 1, found.group(1)) for found in re.finditer(r"^```sh\n(.*?)^```$", text, re.M | re.S)]


def main():
    separate = ["unshare", "-n" if os.geteuid() == 0 else "-rn"]
    if subprocess.run([*separate, "true"], capture_output=True, check=False).returncode != 0:
        print("no network namespace for this user, in which LCM could be tried; run as root")
        return 77
    found = blocks(README.read_text())
    assert len(found) > 10, f"{README}: {len(found)} blocks of commands"
    script = "set -euo pipefail\n"
    for line, commands in found:
        script += f"echo '# line {line}'\n{commands}"
    script = script.replace("build/release", os.path.relpath(BUILD, SOURCE)) + "echo '# end'\n"
    result = subprocess.run([*separate, "bash", "-c", INSIDE], input=script, cwd=SOURCE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            text=True, timeout=600, check=False)
    reached = [line[2:] for line in result.stdout.splitlines() if line.startswith("# ")]
    if result.returncode != 0 or reached[-1:] != ["end"]:
        print(f"FAILED   {README.name}, {reached[-1] if reached else 'before the first block'}: exit {result.returncode}\n{result.stdout[-2000:]}")
        return 1
    for line, commands in found:
        print(f"ok       {README.name} line {line}: {commands.splitlines()[0][:90]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

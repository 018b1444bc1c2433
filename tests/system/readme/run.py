#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of a README as printed: every block in order, in one shell, from the project's root.

usage: run.py README SOURCE_DIR BUILD_DIR [SCENES]

The build folder replaces the printed one. SCENES is a bash file in this folder that supplies what only a user has (a gyro's
recording, a service manager, installed packages): it states the number of `blocks`, prepares the N-th one in before_N(), checks
its result in after_N(), or names in elsewhere_N the test that runs it. LCM, mounts and processes are in their own namespaces.
Exit 77 if that is not possible. A failing block is printed with its line and output.
"""
import os
import pathlib
import re
import subprocess
import sys
import textwrap

README, SOURCE, BUILD = (pathlib.Path(argument) for argument in sys.argv[1:4])
SCENES = pathlib.Path(sys.argv[4]).resolve() if len(sys.argv) > 4 else None
INSIDE = "ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo && exec bash -s"
NOT_POSSIBLE = 77


def blocks(text):
    """Each block's first line and its commands; a block in a list is indented like its item."""
    return [(text[:found.start(2)].count("\n") + 1, textwrap.dedent(found.group(2)))
            for found in re.finditer(r"^( *)```sh\n(.*?)^\1```$", text, re.M | re.S)]


def watched(commands):
    """A list a && b that ends at a does not stop bash, even with -e, so its status is checked. Not inside a text."""
    return re.sub(r"^((?!.*<<).* && .*[^\\\n])\n", r"\1\n[ $? = 0 ]\n", commands, flags=re.M)


def script_of(found, scenes):
    text = "set -euo pipefail\n"
    if scenes:
        text += f"source={SOURCE.resolve()} build={BUILD.resolve()}\n{scenes}\n[ $blocks = {len(found)} ]\n"
    for number, (line, commands) in enumerate(found, 1):
        if re.search(rf"^elsewhere_{number}=", scenes, re.M):
            text += f'echo "# line {line}: elsewhere, $elsewhere_{number}"\n'
            continue
        text += f"echo '# line {line}'\n"
        for there, lines in (("before", watched(commands)), ("after", "")):
            text += (f"{there}_{number}\n" if re.search(rf"^{there}_{number}\(\)", scenes, re.M) else "") + lines
    return text.replace("build/release", os.path.relpath(BUILD, SOURCE)) + "echo '# end'\n"


def main():
    separate = ["unshare", "-nmp" if os.geteuid() == 0 else "-rnmp", "--fork", "--mount-proc", "--kill-child"]
    if subprocess.run([*separate, "true"], capture_output=True, check=False).returncode != 0:
        print("no namespaces for this user, in which LCM could be tried; run as root")
        return NOT_POSSIBLE
    text = README.read_text()
    found = blocks(text)
    assert 0 < len(found) == text.count("```sh\n"), f"{README}: {len(found)} blocks of commands"
    script = script_of(found, SCENES.read_text() if SCENES else "")
    result = subprocess.run([*separate, "bash", "-c", INSIDE], input=script, cwd=SOURCE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            text=True, timeout=600, check=False)
    reached = [line[2:] for line in result.stdout.splitlines() if line.startswith("# ")]
    if result.returncode == NOT_POSSIBLE:
        print(result.stdout.splitlines()[-1])
        return NOT_POSSIBLE
    name = os.path.relpath(README, SOURCE)
    if result.returncode != 0 or reached[-1:] != ["end"]:
        print(f"FAILED   {name}, {reached[-1] if reached else 'before the first block'}: exit {result.returncode}\n{result.stdout[-2000:]}")
        return 1
    for (line, commands), said in zip(found, reached):
        print(f"ok       {name} {said if ':' in said else f'line {line}'}: {commands.splitlines()[0][:90]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

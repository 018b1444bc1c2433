#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The CI workflow must run every stage of `tools/test all`, and no unknown stage.

usage: tests/layout/check_workflow.py
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    script = (ROOT / "tools/test").read_text()
    known = re.search(r"^stages=\((.*?)\)", script, re.M).group(1).split()
    whole = re.search(r"= all \]; then\n  chosen=\((.*?)\)", script, re.M).group(1).split()
    workflow = (ROOT / ".github/workflows/test.yml").read_text()
    run = re.search(r"stages: \[(.*?)\]", workflow).group(1).replace(",", " ").split()
    wrong = [f"'{stage}' is no stage of tools/test" for stage in run if stage not in known]
    wrong += [f"the stage '{stage}' is not run" for stage in whole if stage not in run]
    for line in wrong:
        print(f".github/workflows/test.yml: {line}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

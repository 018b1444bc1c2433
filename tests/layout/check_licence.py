#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every source file says its licence in its first lines, as SPDX has it.

usage: tests/layout/check_licence.py          one line a file that does not; exit 1 when there is one
       tests/layout/check_licence.py --add    puts it there
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
TAG = "SPDX-License-Identifier: Apache-2.0"
SLASHES = {".cpp", ".h", ".c", ".java", ".lcm"}
HASHES = {".py", ".cmake", ".yml"}
# Not labelled: files of released versions, seeds of the fuzzers, and files for other programs.
LEFT_OUT = re.compile(r"^(tests/(stable/[0-9]|fuzz/seeds/)|\.ci/)")


def sources():
    """(file, beginning of its comments)."""
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=False)
    names = listed.stdout.splitlines() if listed.returncode == 0 else [
        str(path.relative_to(ROOT)) for path in ROOT.rglob("*") if path.is_file() and path.relative_to(ROOT).parts[0] not in ("build", ".git")]
    for name in sorted(names):
        path = ROOT / name
        if LEFT_OUT.match(name) or not path.is_file() or path.is_symlink():
            continue
        if path.suffix in SLASHES or name.endswith(".h.in"):
            yield path, "//"
        elif path.suffix in HASHES or path.name == "CMakeLists.txt" or name.endswith(".cmake.in"):
            yield path, "#"
        else:
            with open(path, "rb") as file:
                if file.read(2) == b"#!":
                    yield path, "#"


def main():
    add, missing = sys.argv[1:] == ["--add"], 0
    for path, comment in sources():
        lines = path.read_text().split("\n")
        if any(TAG in line for line in lines[:3]):
            continue
        missing += 1
        if add:
            lines.insert(1 if lines[0].startswith("#!") else 0, f"{comment} {TAG}")
            path.write_text("\n".join(lines))
        else:
            print(f"{path.relative_to(ROOT)}:1: expected '{comment} {TAG}' (tests/layout/check_licence.py --add puts it there)")
    return 1 if missing and not add else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""No two headers may define types of the same name in one namespace. If both are linked into one program, the linker uses one
destructor, and one set of functions of std::vector, for both; no compiler reports that.

usage: tests/layout/check_names.py [TREE] the tree's root; default: this one

One line per violation; exit 1 if there is one.
"""
import collections
import pathlib
import re
import sys

ROOMS = ("daemon", "drivers", "filters", "msgs", "tools")
TYPE = re.compile(r"^(?:template <[^;{]*>\s*)?(?:struct|class|enum class|enum) (\w+)[^;{}()]*\{", re.MULTILINE)


def main():
    tree = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]
    found = collections.defaultdict(set)
    for room in ROOMS:
        for path in sorted((tree / room).rglob("*.h")):
            text = path.read_text()
            space = re.search(r"^namespace ([\w:]+) \{", text, re.MULTILINE)
            for name in TYPE.findall(text):
                found[space[1] if space else "", name].add(str(path.relative_to(tree)))
    wrong = [f"{space}::{name} is a type of {' and of '.join(sorted(files))}" for (space, name), files in sorted(found.items()) if len(files) > 1]
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""Runs a check of the source tree, or its self-test on small trees."""
import pathlib
import sys
import tempfile


def proved(check, good, bad):
    """True if check finds nothing in a tree of `good` files, and finds each added wrong line (file, line, complaint)."""
    right = True
    for extra in [None, *bad]:
        with tempfile.TemporaryDirectory() as tree:
            for name, text in {**good, **({extra[0]: extra[1] + "\n"} if extra else {})}.items():
                path = pathlib.Path(tree) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            said = check(tree)
        if not extra and said:
            right = False
            print("the good tree is refused:", *said, sep="\n  ")
        if extra and not any(extra[2] in line for line in said):
            right = False
            print(f"{extra[0]} with {extra[1]} gives {said}, expected: {extra[2]}")
    return right


def main_of(check, self_test):
    if sys.argv[1:] == ["--self-test"]:
        sys.exit(0 if self_test() else 1)
    complaints = check(sys.argv[1] if len(sys.argv) > 1 else str(pathlib.Path(__file__).resolve().parents[2]))
    print(*complaints, sep="\n", end="\n" if complaints else "")
    sys.exit(1 if complaints else 0)

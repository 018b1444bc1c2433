#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Limits the lines of a source file and of a script's function, the C++ files of a folder, and the members and methods of a class.
(Functions in C++: clang-tidy, readability-function-size.)

usage: tests/layout/check_lengths.py [TREE] the tree's root; default: this one

One line per violation, FILE or FOLDER: what; exit 1 if there is one.
"""
import ast
import collections
import pathlib
import re
import subprocess
import sys

MOST_OF_A_FILE = 400
MOST_OF_A_FUNCTION = 60
MOST_OF_A_FOLDER = 24  # files of C++
MOST_OF_A_CLASS = 15  # data members, whose names end with _
MOST_METHODS = 25  # without constructors, destructor and operators
SOURCES = {".cpp", ".h", ".c", ".py", ".java", ".sh", ".cmake"}


def sources(tree):
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=tree, capture_output=True, text=True, check=False)
    names = listed.stdout.splitlines() if listed.returncode == 0 else [
        str(path.relative_to(tree)) for path in tree.rglob("*") if path.is_file() and path.relative_to(tree).parts[0] not in ("build", ".git")]
    for name in sorted(names):
        path = tree / name
        if not path.is_file() or path.is_symlink():
            continue
        if path.suffix in SOURCES or path.name == "CMakeLists.txt":
            yield name, path.read_text()
        elif not path.suffix and path.read_bytes()[:2] == b"#!":
            yield name, path.read_text()


def classes(text):
    """Name and own statements of each class: without comments, strings and inner braces."""
    text = re.sub(r'//[^\n]*|"(?:[^"\\\n]|\\.)*"', "", text)
    for begin in re.finditer(r"\bclass (\w+)[^;{}()]*\{", text):
        own, depth = [], 1
        for character in text[begin.end():]:
            depth += (character == "{") - (character == "}")
            if depth == 0:
                break
            if depth == 1:
                own.append(character)
        yield begin[1], "".join(own)


def members(own):
    for statement in re.split("[;}]", own):
        if "(" not in statement and not re.match(r"\s*(static|using|friend)\b", statement):
            yield from re.findall(r"\b[a-z]\w*_\b", statement)


def methods(of, own):
    for statement in re.split("[;}]", own):
        named = re.search(r"(~?\w+)\s*\(", re.sub(r"<[^<>]*>", "", statement))
        if named and named[1] not in (of, "~" + of) and "operator" not in statement and not re.match(r"\s*(using|friend|static_assert)\b", statement):
            yield named[1]


def violations(name, text):
    lines = text.count("\n")
    if lines > MOST_OF_A_FILE:
        yield f"{lines} lines, at most {MOST_OF_A_FILE}"
    if name.endswith((".cpp", ".h")):
        for of, own in classes(text):
            if (count := len(set(members(own)))) > MOST_OF_A_CLASS:
                yield f"class {of} has {count} members, at most {MOST_OF_A_CLASS}"
            if (count := len(list(methods(of, own)))) > MOST_METHODS:
                yield f"class {of} has {count} methods, at most {MOST_METHODS}"
    if not name.endswith(".py") and not text.startswith("#!/usr/bin/env python3"):
        return
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.end_lineno - node.lineno >= MOST_OF_A_FUNCTION:
            yield f"{node.name}() has {node.end_lineno - node.lineno + 1} lines, at most {MOST_OF_A_FUNCTION}"


def main():
    tree = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]
    wrong, folders = [], collections.Counter()
    for name, text in sources(tree):
        wrong += [f"{name}: {what}" for what in violations(name, text)]
        folders[str(pathlib.PurePath(name).parent)] += name.endswith((".cpp", ".h"))
    wrong += [f"{folder}: {count} files of C++, at most {MOST_OF_A_FOLDER}" for folder, count in folders.items() if count > MOST_OF_A_FOLDER]
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

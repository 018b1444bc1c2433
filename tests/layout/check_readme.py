#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Keeps the main README short: at most 120 lines, 1500 words, and 35 words per sentence.

usage: tests/layout/check_readme.py [README] default: that of this tree

One line per violation; exit 1 if there is one.
"""
import pathlib
import re
import sys

MOST_LINES, MOST_WORDS, MOST_IN_A_SENTENCE = 120, 1500, 35


def sentences(text):
    """Sentences of prose: without code blocks, tables, headings and pictures."""
    prose = re.sub(r"```.*?```", "", text, flags=re.S)
    prose = re.sub(r"\]\([^)]*\)", "]", re.sub(r"^(\||#|!).*$", "", prose, flags=re.M))
    for paragraph in re.split(r"\n\s*\n", prose):
        yield from re.split(r"(?<=[.!?])\s+", " ".join(paragraph.split()))


def main():
    readme = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2] / "README.md"
    text = readme.read_text()
    wrong = [f"{count} {what}, at most {most}" for count, most, what in (
        (text.count("\n"), MOST_LINES, "lines"), (len(text.split()), MOST_WORDS, "words")) if count > most]
    wrong += [f"a sentence of {len(each.split())} words, at most {MOST_IN_A_SENTENCE}: {each[:60]}"
              for each in sentences(text) if len(each.split()) > MOST_IN_A_SENTENCE]
    for what in wrong:
        print(f"{readme.name}: {what}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

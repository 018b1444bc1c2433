# SPDX-License-Identifier: Apache-2.0
"""A commented TOML file that shows every key, as tables of terms: the reference configuration and the reference model.

What is read:  [table] and [[table]];  key = value  # comment, with the comment going on in lines that are indented further;
a comment in lines of its own before a table or a key, which is a paragraph; and keys that are alternatives, in comments:
  # serial: device = "/dev/ttyUSB0" (remark)
  #         baud = 921600            remark
"""
import re

import roff

VALUE = r'("(?:[^"\\]|\\.)*"|\[[^\]]*\]|[^\s#]+)'
KEY = re.compile(r"^(\s*)([A-Za-z_]\w*) = " + VALUE + r"\s*(?:#\s?(.*))?$")
ALTERNATIVE = re.compile(r"^\s*#\s+(?:(\w+):\s+)?(\w+) = " + VALUE + r"\s*(.*)$")
COMMENT_COLUMN = 20  # from here on a comment continues that of the line before


def strip_brackets(text):
    found = re.fullmatch(r"\((.*)\)", text.strip())
    return found.group(1) if found else text.strip()


def entries(text):
    """('table', name) | ('text', words) | ('key', where, key, value, comment), in the order of the file."""
    out, where = [], ""
    for line in text.splitlines():
        if not line.strip():
            out.append(("end",))
        elif found := re.match(r"\s*(\[\[?[\w.]+\]\]?)\s*(?:#\s?(.*))?$", line):
            out.append(("table", found.group(1)))
            where = ""
            if found.group(2):
                out.append(("text", found.group(2)))
        elif found := KEY.match(line):
            out.append(["key", "", found.group(2), found.group(3), found.group(4) or ""])
        elif line.lstrip().startswith("#"):
            words = line.strip().lstrip("#")
            inner = len(line) - len(line.lstrip()) + len(words) - len(words.lstrip())
            if found := ALTERNATIVE.match(line):
                where = found.group(1) or where
                out.append(["key", where, found.group(2), found.group(3), strip_brackets(found.group(4))])
            elif inner >= COMMENT_COLUMN - 10 and out[-1][0] == "key" and len(line) - len(line.lstrip()) < COMMENT_COLUMN <= inner:
                out[-1][4] += " " + words.strip()
            elif out and out[-1][0] == "key" and (len(line) - len(line.lstrip()) >= COMMENT_COLUMN or words.startswith("   ")):
                out[-1][4] += ("; " if out[-1][1] or words.strip().startswith("of ") else " ") + words.strip()
            elif out and out[-1][0] == "text":
                out[-1] = ("text", out[-1][1] + " " + words.strip())
            else:
                out.append(("text", words.strip()))
        else:
            raise SystemExit(f"a line of the reference that is neither table, key nor comment: {line!r}")
    return [entry for entry in out if entry[0] != "end"]


def keys(text):
    """Every key with its table: {('[sensor.transport]', 'device'), ...}."""
    table, found = "", set()
    for entry in entries(text):
        if entry[0] == "table":
            table = entry[1]
        elif entry[0] == "key":
            found.add((table, entry[2]))
    return found


def lines(text):
    """The file as roff: a subsection a table, a tagged paragraph a key. What is said before a table stands behind its name."""
    listed = entries(text)
    # A comment of its own right before a table is the table's.
    for at in range(len(listed) - 1):
        if listed[at][0] == "text" and listed[at + 1][0] == "table" and at > 0:
            listed[at], listed[at + 1] = listed[at + 1], listed[at]
    out = []
    for entry in listed:
        if entry[0] == "table":
            out.append(f'.SS "{roff.exact(entry[1])}"')
        elif entry[0] == "text":
            out += [".PP", *roff.sentences(entry[1])]
        else:
            _, where, key, value, comment = entry
            of = f" ({where})" if where else ""
            out += roff.tagged(f"`{key} = {value}`{of}", comment or "an example")
    return out + [".PP"]
